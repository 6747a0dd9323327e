#include "tracker_worker.h"

#include <utility>

#include <ros/ros.h>
#include <boost/make_shared.hpp>

#include "input_conversion.h"
#include "mba_vo/io/photometric_files.h"
#include "mba_vo/ros/status_conversion.h"
#include "node_constants.h"

namespace mba_vo {
namespace {

constexpr double kNumbersPerSecond = 1e3;
constexpr double kCorrectionPeriod = 30.0;  // [s] at most one line in it, of many small steps

double now() { return ros::SteadyTime::now().toSec(); }

TrackerPipelineConfig pipelineConfig(const NodeConfig& config) {
  return {config.odometry, loadPhotometricCalibration(config.odometry.image),
          static_cast<std::size_t>(kBytesPerMegabyte * config.image_queue_mb), true};
}

std::unique_ptr<OnlineRecord> openRecord(const NodeConfig& config) {
  if (!config.record) return nullptr;
  try {
    return std::make_unique<OnlineRecord>(config.output_directory);
  } catch (const std::exception& error) {
    ROS_ERROR_STREAM("nothing that is published will be written down: " << error.what());
    return nullptr;
  }
}

}  // namespace

TrackerWorker::TrackerWorker(ros::NodeHandle& nh, const NodeConfig& config, StatusReporter& status)
    : config_(config),
      // The trajectory store knows frames by number: a tracker that is restarted must not use numbers again.
      first_sequence_(static_cast<std::uint64_t>(kNumbersPerSecond * ros::WallTime::now().toSec())),
      stamp_reference_(config.stampReference()),
      memory_(config.odometry.image),
      status_(status),
      tracked_frames_(nh.advertise<TrackedFrameMessage>("tracked_frame", 1000)),
      motions_(nh, config.frames, config.publish_tf),
      view_(nh, config.frames.map_frame),
      pipeline_(pipelineConfig(config), ros::WallTime::now().toNSec()),  // differs from any tracker's before
      record_(openRecord(config)),
      extrinsic_(config.frames.base_frame, config.extrinsic_wait),
      thread_({[this] { return step(); }, [this](const std::string& what) { recover(what); }}) {}

/// What still waits will not be tracked any more.
TrackerWorker::~TrackerWorker() {
  thread_.stop();
  if (!record_) return;
  for (const CameraImage& image : pipeline_.takeImages()) recordShed(image, "the tracker was ended");
  try {
    record_->finish();
  } catch (const std::exception& error) {
    ROS_ERROR_STREAM(error.what());
  }
}

void TrackerWorker::addImage(const InputImage& image) {
  CameraImage converted = toCameraImage(image, stamp_reference_);
  converted.sequence += first_sequence_;
  for (const CameraImage& shed : pipeline_.addImage(std::move(converted), image.arrival)) {
    ROS_WARN_THROTTLE(kWarnPeriod, "images are shed: the tracker does not keep up with the camera");
    status_.imageShed(shed.stamp_ns);
    recordShed(shed, "the tracker does not keep up with the camera");
  }
  thread_.wake();
}

void TrackerWorker::addReference(const ReferenceMessageConstPtr& reference) {
  status_.mapperSaid(reference->summary.status);
  pipeline_.addReference({reference->summary.session, reference->reference});
  thread_.wake();
}

void TrackerWorker::setCalibration(const CameraCalibration& calibration) {
  CalibrationCorrection known;
  try {
    known = memory_.recall(calibration);
  } catch (const std::exception& error) {
    ROS_ERROR_STREAM("what was learnt of the camera is not used, and nothing more is kept: " << error.what());
  }
  pipeline_.setCalibration(calibration, known);
  thread_.wake();
}

void TrackerWorker::keepLearnt(const CalibrationCorrection& correction) {
  try {
    memory_.keep(correction);
  } catch (const std::exception& error) {
    ROS_ERROR_STREAM_THROTTLE(kWarnPeriod, "what was learnt of the camera is not kept: " << error.what());
  }
}

void TrackerWorker::reset() {
  pipeline_.requestReset();
  thread_.wake();
}

bool TrackerWorker::step() {
  recorded_ = false;
  const std::optional<TrackerStep> step = pipeline_.step();
  tellAdopted();
  if (!step) return false;
  if (step->began_anew) {
    last_measured_ns_ = 0;
    status_.wasReset(step->reason);
    view_.clearMarkers();
    ROS_INFO_STREAM("a new map begins: " << step->reason);
  }
  if (step->message.tracked) {
    extrinsic_.setCamera(step->message.mount.camera_frame);
    forward(step->message);
    for (const TrackerMessage& placed : step->placed) forward(placed);
  }
  if (!step->notice.empty()) ROS_WARN_STREAM(step->notice);
  if (step->kind == TrackerStep::Kind::kImage) {
    publishImage(*step);
  } else if (step->kind == TrackerStep::Kind::kRepeated) {
    publishRepeated(*step);
  } else if (step->kind == TrackerStep::Kind::kRejected) {
    ROS_WARN_STREAM_THROTTLE(kWarnPeriod, nameOf(*step) << " rejected: " << step->reason);
    status_.imageRejected(step->stamp_ns, step->reason);
    record(*step);
  }
  if (step->endsImage()) latency_ = now() - step->arrival;
  console_.tell(*step);
  return true;
}

/// The image that was being worked on has no result any more.
void TrackerWorker::recover(const std::string& what) {
  pipeline_.requestReset();
  ROS_ERROR_STREAM("the tracker failed and begins anew: " << what);
  const std::optional<TrackerStep>& image = pipeline_.imageInWork();
  const bool without_result = image && !recorded_;
  status_.trackerFailed(what, without_result);
  if (!without_result) return;
  TrackerStep failed = *image;
  failed.kind = TrackerStep::Kind::kRejected;
  failed.reason = "the tracker failed: " + what;
  record(failed);
}

void TrackerWorker::tellAdopted() {
  for (const ReferenceConstPtr& reference : pipeline_.takeAdopted()) {
    status_.referenceAdopted(*reference);
    corrected_ = !reference->correction.values.isZero(0.0);
    const auto& settled = reference->settled_correction;
    if (settled && settled != std::exchange(kept_, settled)) keepLearnt(*settled);
    if (pipeline_.takeCorrected()) {
      ROS_WARN_STREAM_THROTTLE(
          kCorrectionPeriod,
          "the images say that the calibration is wrong; it is corrected by focal length (relative), centre "
          "(focal lengths), k1, k2, time of read-out [s], vignette: "
              << reference->correction.values.transpose());
    }
  }
  for (std::size_t stale = pipeline_.takeStale(); stale > 0; --stale) status_.referenceStale();
}

void TrackerWorker::forward(const TrackerMessage& message) {
  if (std::exchange(session_, message.session) != message.session) next_number_ = 0;
  const auto out = boost::make_shared<TrackedFrameMessage>();
  out->message = message;
  if (message.tracked->hasPose() || extrinsic_.isSettled()) {  // without a pose there is nothing to place yet
    out->message.mount.T_base_camera = extrinsic_.T_base_camera();
  }
  out->summary = summarize(message);
  out->summary.number = next_number_++;
  out->summary.sequence -= first_sequence_;
  tracked_frames_.publish(TrackedFrameMessageConstPtr(out));
}

void TrackerWorker::publishImage(const TrackerStep& step) {
  const TrackedFrame& tracked = *step.message.tracked;
  if (!step.reason.empty()) ROS_WARN_STREAM_THROTTLE(kWarnPeriod, nameOf(step) << ": " << step.reason);
  if (tracked.hasPose() || (tracked.orientation_only && extrinsic_.isSettled())) publishMotion(step);
  record(step);
  status_.imageTracked(tracked, exposureSource(step), publishPrediction(step));
  view_.publishImage(tracked, pipeline_.tracking().reference(), step.message.mount.camera_frame);
}

/// The pose goes to those who join it with images by their stamps; for all others it is no news.
void TrackerWorker::publishRepeated(const TrackerStep& step) {
  if (step.repeated && step.repeated->hasPose()) {
    motions_.publishExposureMotion(motionOf(step, step.repeated, step.T_odom_camera));
  }
  record(step);
  status_.imageRepeated(step.stamp_ns, step.reason);
}

void TrackerWorker::publishMotion(const TrackerStep& step) {
  const MeasuredMotion motion = motionOf(step, step.message.tracked, step.T_odom_camera);
  motions_.publish(motion);
  if (!step.message.tracked->tracked()) return;
  last_measured_ns_ = step.mid_exposure_ns;
  view_.publishMarkers(motion, pipeline_.tracking().reference());
}

bool TrackerWorker::publishPrediction(const TrackerStep& step) {
  if (!step.predicted_T_odom_camera || step.message.tracked->predicted || !config_.publish_tf) return false;
  if (!(secondsSinceMeasured(*step.message.tracked->frame) < config_.tf_prediction)) return false;
  motions_.publishPrediction(motionOf(step, step.message.tracked, *step.predicted_T_odom_camera));
  return true;
}

void TrackerWorker::record(const TrackerStep& step) {
  recorded_ = true;
  if (!record_) return;
  try {
    record_->add({numbered(step), now()});
  } catch (const std::exception& error) {
    ROS_ERROR_STREAM(error.what());
  }
}

void TrackerWorker::recordShed(const CameraImage& image, const std::string& reason) {
  if (record_) record_->addShed(numbered(stepOfShed(image, reason)));
}

/// As the outside counts.
TrackerStep TrackerWorker::numbered(TrackerStep step) const {
  step.sequence -= first_sequence_;
  return step;
}

std::string TrackerWorker::nameOf(const TrackerStep& step) const {
  return "image " + std::to_string(step.sequence - first_sequence_) + " of " +
         std::to_string(1e-9 * static_cast<double>(step.stamp_ns)) + " s";
}

MeasuredMotion TrackerWorker::motionOf(const TrackerStep& step, const TrackedFrameConstPtr& tracked,
                                       const SE3& T_odom_camera) {
  MeasuredMotion motion;
  motion.tracked = tracked;
  motion.T_odom_camera = T_odom_camera;
  motion.motion = step.motion;
  motion.T_map_odom = step.T_map_odom;
  motion.T_base_camera = extrinsic_.T_base_camera();
  motion.camera_frame = step.message.mount.camera_frame;
  motion.covariance = step.covariance;
  return motion;
}

double TrackerWorker::secondsSinceMeasured(const Frame& frame) const {
  return last_measured_ns_ != 0 ? 1e-9 * static_cast<double>(frame.mid_exposure_ns - last_measured_ns_) : 0.0;
}

}  // namespace mba_vo
