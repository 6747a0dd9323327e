#include "mba_vo/odometry/tracker_pipeline.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "mba_vo/odometry/tracking_results.h"

namespace mba_vo {
namespace {

constexpr std::size_t kImageBacklog = 8;   // so many images wait: the tracker is behind, and does not go back as well
constexpr std::size_t kTooManyImages = 2;  // behind an image: with one, the delay is less than two intervals

constexpr const char* kLeaps =
    "images come faster than they can be tracked: some are left out, and placed by their neighbours for the trajectory";

/// What is known of it before anything is done with it.
TrackerStep stepOf(const CameraImage& image) {
  TrackerStep step;
  step.sequence = image.sequence;
  step.stamp_ns = image.stamp_ns;
  step.mid_exposure_ns = image.mid_exposure_ns;
  step.arrival = image.arrival;
  step.exposure_from_topic = image.exposure_from_topic;
  return step;
}

}  // namespace

TrackerStep stepOfShed(const CameraImage& image, const std::string& reason) {
  TrackerStep step = stepOf(image);
  step.kind = TrackerStep::Kind::kShed;
  step.reason = "shed: " + reason;
  return step;
}

TrackerPipeline::TrackerPipeline(const TrackerPipelineConfig& config, std::uint64_t first_session)
    : queue_(config.max_queue_bytes, bytesOf, mostDispensable),
      intake_(config.odometry.image, config.photometric, config.correct_in_background),
      loop_(config.odometry),
      session_(first_session) {}

std::vector<CameraImage> TrackerPipeline::addImage(CameraImage image, double arrival) {
  image.arrival = arrival;
  std::vector<CameraImage> shed;
  for (const Job& job : queue_.push(std::move(image))) shed.push_back(std::get<CameraImage>(job));
  return shed;
}

void TrackerPipeline::addFrame(const FrameConstPtr& frame) { queue_.push(frame); }

void TrackerPipeline::addReference(const MapperMessage& reference) {
  const std::lock_guard<std::mutex> lock(references_mutex_);
  references_.push_back(reference);
}

void TrackerPipeline::setCalibration(const CameraCalibration& calibration, const CalibrationCorrection& known) {
  queue_.push(KnownCamera{calibration, known});
}

void TrackerPipeline::requestReset() { queue_.push(ResetRequest()); }

std::optional<TrackerStep> TrackerPipeline::step() {
  in_work_.reset();
  adoptReferences();
  auto step = withPhase(nextStep());
  if (!step) rest();
  return step;
}

std::optional<TrackerStep> TrackerPipeline::finishStep() {
  adoptReferences();
  return withPhase(trackWaiting(false));
}

std::optional<TrackerStep> TrackerPipeline::withPhase(std::optional<TrackerStep> step) const {
  if (step) step->phase = loop_.phase();
  return step;
}

std::optional<TrackerStep> TrackerPipeline::nextStep() {
  if (turn() == Turn::kWaitingFrame) {
    if (auto late = trackWaiting(true)) return late;
  }
  return queue_.empty() ? std::nullopt : std::optional(takeJob());
}

std::vector<ReferenceConstPtr> TrackerPipeline::takeAdopted() { return std::exchange(adopted_, {}); }

std::size_t TrackerPipeline::takeStale() { return std::exchange(stale_, 0); }

bool TrackerPipeline::takeCorrected() { return std::exchange(corrected_, false); }

std::vector<CameraImage> TrackerPipeline::takeImages() {
  std::vector<CameraImage> images;
  while (const std::optional<Job> job = queue_.pop()) {
    if (const auto* image = std::get_if<CameraImage>(&*job)) images.push_back(*image);
  }
  return images;
}

/// What is done next, where both images and frames of before wait.
TrackerPipeline::Turn TrackerPipeline::turn() const {
  const Turn queue = queue_.empty() ? Turn::kNothing : Turn::kQueue;
  switch (loop_.phase()) {
    case TrackingPhase::kNoMap:
    case TrackingPhase::kTracking:
    case TrackingPhase::kLost:
      return queue;
    // New images need not wait for frames that have a pose already.
    case TrackingPhase::kRevising:
      return queue == Turn::kQueue ? queue : Turn::kWaitingFrame;
    // Where the camera is now is known only when they have been tracked.
    case TrackingPhase::kGoingBack:
      return Turn::kWaitingFrame;
    // A new image can only be told to wait, which is soon done: by turns, unless the newest is what is tracked next.
    case TrackingPhase::kCatchingUp:
      return queue == Turn::kQueue && (late_since_image_ || loop_.isInHurry()) ? queue : Turn::kWaitingFrame;
  }
  return queue;
}

void TrackerPipeline::adoptReferences() {
  std::vector<MapperMessage> references;
  {
    const std::lock_guard<std::mutex> lock(references_mutex_);
    references.swap(references_);
  }
  for (const MapperMessage& message : references) {
    if (message.session == session_ && loop_.take(message.reference, queue_.size() < kImageBacklog)) {
      corrected_ = intake_.correct(message.reference->correction) || corrected_;
      adopted_.push_back(message.reference);
    } else {
      ++stale_;
    }
  }
}

TrackerStep TrackerPipeline::takeJob() {
  const std::optional<Job> job = queue_.pop();
  if (const auto* image = std::get_if<CameraImage>(&*job)) return takeImage(*image);
  if (const auto* frame = std::get_if<FrameConstPtr>(&*job)) return takeFrame(*frame);
  if (const auto* camera = std::get_if<KnownCamera>(&*job)) return takeCalibration(*camera);
  return reset("reset");
}

TrackerStep TrackerPipeline::takeFrame(const FrameConstPtr& frame) {
  late_since_image_ = false;
  TrackerStep step;
  track(frame, false, step);
  return step;
}

/// While frames of the past are tracked, images wait on every machine.
std::string TrackerPipeline::relieve() {
  if (loop_.phase() == TrackingPhase::kGoingBack) return "";
  const bool waited = !std::exchange(idle_since_image_, false);
  return load_.isTooHigh(waited || loop_.phase() == TrackingPhase::kCatchingUp) ? intake_.halve() : std::string();
}

TrackerStep TrackerPipeline::takeImage(const CameraImage& image) {
  late_since_image_ = false;
  TrackerStep step = stepOf(image);
  in_work_ = step;
  step.notice = relieve();
  const ImageIntake::Result taken = intake_.take(image);
  step.build_ms = taken.build_ms;
  if (taken.clock_restarted) beginSession();
  step.began_anew = taken.clock_restarted;
  step.reason = taken.reason;
  camera_frame_ = image.camera_frame;
  step.contradicts_calibration = taken.contradicts_calibration;
  if (taken.frame) {
    track(taken.frame, taken.repeats.has_value(), step);
  } else if (taken.repeats) {
    repeat(image, step);
  } else {
    step.kind = TrackerStep::Kind::kRejected;
  }
  return step;
}

Backlog TrackerPipeline::backlog() const {
  const std::size_t images = queue_.size();
  if (images == 0) return Backlog::kNothing;
  return images < kTooManyImages ? Backlog::kSome : Backlog::kTooMuch;
}

void TrackerPipeline::track(const FrameConstPtr& frame, bool frozen, TrackerStep& step) {
  step.kind = TrackerStep::Kind::kImage;
  step.exposure = frame->exposure;
  const bool keeps_up = loop_.phase() == TrackingPhase::kTracking || loop_.phase() == TrackingPhase::kRevising;
  const TrackedFrameConstPtr tracked = loop_.process(frame, backlog(), frozen);
  if (keeps_up && loop_.phase() == TrackingPhase::kCatchingUp && !std::exchange(told_of_leaps_, true)) {
    step.notice += step.notice.empty() ? kLeaps : std::string("; ") + kLeaps;
  }
  addResult(tracked, step);
  step.failed_leap = loop_.hasFailedToLeap();
  step.T_odom_camera = loop_.T_odom_camera();
  step.T_map_odom = loop_.T_map_odom();
  step.motion = tracked->tracked() ? loop_.velocity().motion : tracked->trajectory.motion();
  step.covariance = covariance_.update(*tracked, loop_.velocity(), step.T_odom_camera, step.T_map_odom);
  const bool reckoned = loop_.reference() && (tracked->orientation_only || tracked->predicted);
  if (reckoned) step.predicted_T_odom_camera = step.T_odom_camera;
  if (!reckoned && tracked->status == TrackingStatus::kLost)
    step.predicted_T_odom_camera = loop_.predicted_T_odom_camera(frame->mid_exposure_ns);
  last_ = step;
}

void TrackerPipeline::addResult(const TrackedFrameConstPtr& tracked, TrackerStep& step) {
  step.sequence = tracked->frame->sequence;
  step.stamp_ns = tracked->frame->stamp_ns;
  step.mid_exposure_ns = tracked->frame->mid_exposure_ns;
  step.message = messageOf(tracked);
  for (const TrackedFrameConstPtr& placed : loop_.takeInterpolated()) step.placed.push_back(messageOf(placed));
}

/// The image was exposed when the one that it repeats was, and the camera was there then.
void TrackerPipeline::repeat(const CameraImage& image, TrackerStep& step) const {
  step.kind = TrackerStep::Kind::kRepeated;
  if (!last_.message.tracked) return;
  step.mid_exposure_ns = last_.mid_exposure_ns;
  step.exposure = last_.exposure;
  step.repeated = stampedAgain(*last_.message.tracked, image.sequence, image.stamp_ns);
  step.T_odom_camera = last_.T_odom_camera;
  step.motion = last_.motion;
  step.T_map_odom = last_.T_map_odom;
  step.covariance = last_.covariance;
}

TrackerStep TrackerPipeline::takeCalibration(const KnownCamera& camera) {
  const bool another = intake_.isCalibrated();
  intake_.setCalibration(camera.calibration, camera.correction);
  return another ? reset("the calibration has changed") : TrackerStep();
}

std::optional<TrackerStep> TrackerPipeline::trackWaiting(bool may_hold) {
  const TrackedFrameConstPtr tracked = loop_.trackWaiting(may_hold);
  late_since_image_ = true;
  TrackerStep step;
  step.failed_leap = loop_.hasFailedToLeap();
  if (!tracked) return step.failed_leap ? std::optional(step) : std::nullopt;
  step.kind = TrackerStep::Kind::kLate;
  addResult(tracked, step);
  return step;
}

TrackerStep TrackerPipeline::reset(const std::string& reason) {
  intake_.reset();
  beginSession();
  TrackerStep step;
  step.kind = TrackerStep::Kind::kReset;
  step.began_anew = true;
  step.reason = reason;
  return step;
}

/// Nothing of what went before counts any more, for the mapper neither.
void TrackerPipeline::beginSession() {
  ++session_;
  keep_map_ = false;
  loop_.reset();
  covariance_.reset();
  last_ = {};
}

TrackerMessage TrackerPipeline::messageOf(const TrackedFrameConstPtr& tracked) const {
  return {session_, keep_map_, loop_.reference() != nullptr, {camera_frame_, SE3()}, tracked};
}

std::size_t TrackerPipeline::bytesOf(const Job& job) {
  const auto* image = std::get_if<CameraImage>(&job);
  if (!image) return 0;
  return image->image.total() * image->image.elemSize() + image->depth.total() * sizeof(float);
}

/// The image whose neighbours are closest in time: images are thinned out evenly, so that the camera moves as little as
/// possible between those that remain. Neither the oldest nor the newest, if there are others.
std::size_t TrackerPipeline::mostDispensable(const std::deque<Job>& jobs) {
  std::vector<std::size_t> images;
  std::vector<std::int64_t> stamps;  // [ns]
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const auto* image = std::get_if<CameraImage>(&jobs[i]);
    if (!image) continue;
    images.push_back(i);
    stamps.push_back(image->stamp_ns);
  }
  std::size_t best = images.empty() ? jobs.size() : images.front();
  std::int64_t closest = std::numeric_limits<std::int64_t>::max();
  for (std::size_t k = 1; k + 1 < images.size(); ++k) {
    const std::int64_t distance = stamps[k + 1] - stamps[k - 1];
    if (distance >= closest) continue;
    closest = distance;
    best = images[k];
  }
  return best;
}

}  // namespace mba_vo
