#include "tracker_worker.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include <ros/ros.h>
#include <boost/make_shared.hpp>

#include "mba_vo/io/photometric_files.h"
#include "mba_vo/ros/image_conversion.h"
#include "mba_vo/ros/status_conversion.h"

namespace mba_vo {
namespace {

constexpr double kBytesPerMegabyte = 1e6;
constexpr double kWarnPeriod = 5.0;  // [s]
constexpr std::size_t kBacklog = 8;  // so many images wait: the tracker is behind

}  // namespace

std::size_t TrackerWorker::bytesOf(const Job& job) {
  const auto* image = std::get_if<InputImage>(&job);
  return image ? image->message->data.size() + (image->depth ? image->depth->data.size() : 0) : 0;
}

/// The image whose neighbours are closest in time: images are thinned out evenly, so that the camera moves as little as
/// possible between those that remain. Neither the oldest nor the newest, if there are others.
std::size_t TrackerWorker::mostDispensable(const std::deque<Job>& jobs) {
  std::vector<std::size_t> images;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if (std::holds_alternative<InputImage>(jobs[i])) {
      images.push_back(i);
    }
  }
  const auto seconds = [&](std::size_t job) { return std::get<InputImage>(jobs[job]).message->header.stamp.toSec(); };
  std::size_t best = images.front();
  double closest = std::numeric_limits<double>::max();
  for (std::size_t k = 1; k + 1 < images.size(); ++k) {
    const double distance = seconds(images[k + 1]) - seconds(images[k - 1]);
    if (distance < closest) {
      closest = distance;
      best = images[k];
    }
  }
  return best;
}

TrackerWorker::TrackerWorker(ros::NodeHandle& nh, const NodeConfig& config, CalibrationStore& calibration,
                             StatusReporter& status)
    : config_(config),
      calibration_(calibration),
      status_(status),
      photometric_(
          loadPhotometricCalibration(config.odometry.image.response_file, config.odometry.image.vignette_file)),
      stamp_reference_(config.stampReference()),
      tracked_frames_(nh.advertise<TrackedFrameMessage>("tracked_frame", 1000)),
      motions_(nh, config.frames, config.publish_tf),
      queue_(static_cast<std::size_t>(kBytesPerMegabyte * config.image_queue_mb), bytesOf, mostDispensable),
      loop_(config.odometry),
      extrinsic_(config.frames.base_frame, config.extrinsic_wait) {
  beginSession(true);
  thread_ = std::thread([this] { run(); });
}

TrackerWorker::~TrackerWorker() {
  queue_.stop();
  thread_.join();
}

void TrackerWorker::addImage(const InputImage& image) {
  for (const Job& shed : queue_.push(image)) {
    ROS_WARN_THROTTLE(kWarnPeriod, "images are shed: the tracker does not keep up with the camera");
    status_.imageShed(toNanoseconds(std::get<InputImage>(shed).message->header.stamp));
  }
}

void TrackerWorker::addReference(const ReferenceMessageConstPtr& reference) {
  {
    const std::lock_guard<std::mutex> lock(references_mutex_);
    references_.push_back(reference);
  }
  queue_.push(NewReference());
}

void TrackerWorker::reset() { queue_.push(Reset()); }

void TrackerWorker::run() {
  while (const std::optional<Job> job = queue_.pop()) {
    if (const auto* image = std::get_if<InputImage>(&*job)) {
      process(*image);
    } else if (std::holds_alternative<Reset>(*job)) {
      beginSession(false);
    }
    catchUp(false);
  }
}

void TrackerWorker::beginSession(bool keep_map) {
  session_ = std::max(session_ + 1, ros::WallTime::now().toNSec());  // differs from that of any tracker before
  keep_map_ = keep_map;
  next_number_ = 0;
  last_measured_ns_ = 0;
  guard_.reset();
  if (!keep_map) {
    loop_.reset();
    correction_ = {};
    next_builder_ = {};
    if (builder_) {
      builder_->correct(correction_);
    }
    status_.wasReset();
    ROS_INFO("tracker was reset: a new map begins");
  }
}

void TrackerWorker::process(const InputImage& image) {
  const FrameConstPtr frame = makeFrame(image);
  if (!frame) {
    return;
  }
  camera_frame_ = image.message->header.frame_id;
  extrinsic_.setCamera(camera_frame_);
  catchUp(true);
  const TrackedFrameConstPtr tracked = loop_.process(frame, queue_.size() == 0);
  forward(tracked, loop_.reference() != nullptr);
  if (tracked->tracked() || (tracked->orientation_only && extrinsic_.isSettled())) {
    publishMotion(tracked);
  }
  status_.imageTracked(*tracked, exposureSource(image, *tracked), publishPrediction(tracked));
}

FrameConstPtr TrackerWorker::makeFrame(const InputImage& image) {
  const std::int64_t stamp_ns = toNanoseconds(image.message->header.stamp);
  const auto reject = [&](const std::string& reason) {
    ROS_WARN_STREAM_THROTTLE(kWarnPeriod, "image " << image.sequence << " rejected: " << reason);
    status_.imageRejected(stamp_ns, reason);
    return nullptr;
  };
  if (stamp_ns == 0) {
    return reject("its stamp is zero");
  }
  InputVerdict verdict = guard_.check(stamp_ns, image.exposure);
  if (verdict.clock_restarted) {
    ROS_WARN_STREAM(verdict.reason << ": taken for a new start");
    beginSession(false);
    verdict = guard_.check(stamp_ns, image.exposure);
  }
  if (!verdict.accepted) {
    return reject(verdict.reason);
  }
  if (!verdict.reason.empty()) {
    ROS_WARN_STREAM_THROTTLE(kWarnPeriod, "image " << image.sequence << ": " << verdict.reason);
  }
  try {
    updateFrameBuilder();
    const cv_bridge::CvImageConstPtr pixels = toCvImage(image.message);
    return builder_->build(pixels->image, image.sequence, stamp_ns,
                           midExposure(stamp_ns, verdict.exposure, stamp_reference_), verdict.exposure, depthOf(image));
  } catch (const std::invalid_argument& error) {
    return reject(error.what());
  }
}

cv::Mat1f TrackerWorker::depthOf(const InputImage& image) const {
  if (!image.depth) return {};
  const PinholeCamera& camera = builder_->camera();
  try {
    cv::Mat1f depth = depthFromMessage(image.depth);
    if (depth.cols == camera.width && depth.rows == camera.height) return depth;
    ROS_WARN_STREAM_THROTTLE(kWarnPeriod, "depth image is not used: it is " << depth.cols << "x" << depth.rows
                                                                            << ", the image's calibration says "
                                                                            << camera.width << "x" << camera.height);
  } catch (const std::invalid_argument& error) {
    ROS_WARN_STREAM_THROTTLE(kWarnPeriod, "depth image is not used: " << error.what());
  }
  return {};
}

void TrackerWorker::updateFrameBuilder() {
  const std::shared_ptr<const CameraCalibration> calibration = calibration_.get();
  if (!calibration) {
    throw std::invalid_argument(calibration_.problem());
  }
  if (next_builder_.valid() && next_builder_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    builder_ = next_builder_.get();
  }
  if (calibration == built_for_) {
    return;
  }
  next_builder_ = {};
  builder_ = std::make_unique<FrameBuilder>(*calibration, photometric_, config_.odometry.image);
  if (std::exchange(built_for_, calibration)) {
    ROS_WARN("the calibration has changed");
    beginSession(false);
  }
}

void TrackerWorker::adoptReferences() {
  std::vector<ReferenceMessageConstPtr> references;
  {
    const std::lock_guard<std::mutex> lock(references_mutex_);
    references.swap(references_);
  }
  for (const ReferenceMessageConstPtr& message : references) {
    if (message->summary.session != session_) {
      status_.referenceStale();
      continue;
    }
    const bool has_time = queue_.size() < kBacklog;
    if (loop_.take(message->reference, has_time)) {
      status_.referenceAdopted(*message->reference, message->summary.status);
      correctCalibration(message->reference->correction);
    } else {
      status_.referenceStale();
    }
  }
}

void TrackerWorker::correctCalibration(const CalibrationCorrection& correction) {
  if (!builder_ || correction == correction_) {
    return;
  }
  correction_ = correction;
  // Making its maps takes longer than tracking an image: images go on being made as before meanwhile.
  next_builder_ = std::async(std::launch::async, [this, calibration = built_for_, correction] {
    auto builder = std::make_unique<FrameBuilder>(*calibration, photometric_, config_.odometry.image);
    builder->correct(correction);
    return builder;
  });
  ROS_WARN_STREAM(
      "the images say that the calibration is wrong; it is corrected by focal length (relative), centre "
      "(focal lengths), k1, k2, row time [s]: "
      << correction.values.transpose());
}

void TrackerWorker::catchUp(bool image_waits) {
  adoptReferences();
  while (!(image_waits && loop_.goesAhead())) {
    const TrackedFrameConstPtr late = loop_.trackWaiting();
    if (!late) {
      return;
    }
    forward(late, true);
    adoptReferences();
    image_waits = image_waits || !queue_.empty();
    // Images that come meanwhile are told to wait, unless there are so many that this would never end.
    if (image_waits && loop_.catchesUp() && queue_.size() < kBacklog) {
      return;
    }
  }
}

void TrackerWorker::forward(const TrackedFrameConstPtr& tracked, bool has_reference) {
  const auto message = boost::make_shared<TrackedFrameMessage>();
  message->summary = summarize(*tracked, camera_frame_, has_reference);
  message->summary.session = session_;
  message->summary.keep_map = keep_map_;
  message->summary.number = next_number_++;
  message->tracked = tracked;
  if (tracked->tracked() || extrinsic_.isSettled()) {  // without a pose there is nothing to place yet
    message->T_base_camera = extrinsic_.T_base_camera();
  }
  tracked_frames_.publish(TrackedFrameMessageConstPtr(message));
}

MeasuredMotion TrackerWorker::motionOf(const TrackedFrameConstPtr& tracked, const SE3& T_odom_camera) {
  MeasuredMotion motion;
  motion.tracked = tracked;
  motion.T_odom_camera = T_odom_camera;
  motion.T_map_odom = loop_.T_map_odom();
  motion.T_base_camera = extrinsic_.T_base_camera();
  motion.camera_frame = camera_frame_;
  motion.seconds_since_previous = secondsSinceMeasured(*tracked->frame);
  return motion;
}

double TrackerWorker::secondsSinceMeasured(const Frame& frame) const {
  return last_measured_ns_ != 0 ? 1e-9 * static_cast<double>(frame.mid_exposure_ns - last_measured_ns_) : 0.0;
}

void TrackerWorker::publishMotion(const TrackedFrameConstPtr& tracked) {
  motions_.publish(motionOf(tracked, loop_.T_odom_camera()));
  if (tracked->tracked()) last_measured_ns_ = tracked->frame->mid_exposure_ns;
}

bool TrackerWorker::publishPrediction(const TrackedFrameConstPtr& tracked) {
  if (tracked->status != TrackingStatus::kLost || !config_.publish_tf) return false;
  if (!(secondsSinceMeasured(*tracked->frame) < config_.tf_prediction)) return false;
  const std::optional<SE3> T_odom_camera = loop_.predicted_T_odom_camera(tracked->frame->mid_exposure_ns);
  if (!T_odom_camera) return false;
  motions_.publishPrediction(motionOf(tracked, *T_odom_camera));
  return true;
}

}  // namespace mba_vo
