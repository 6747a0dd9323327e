#include "mba_vo/odometry/frame_tracking.h"

#include "mba_vo/odometry/tracking_results.h"

namespace mba_vo {
namespace {

double secondsBetween(const TrackingState& last, const Frame& frame) {
  return 1e-9 * static_cast<double>(frame.mid_exposure_ns - last.lastNs());
}

}  // namespace

FrameTracking::FrameTracking(const TrackerConfig& config)
    : config_(config), tracker_(config), exposures_(config), judge_(config) {}

void FrameTracking::begin(const ReferenceConstPtr& reference, const SE3& T_odom_hint) {
  reference_ = reference;
  state_ = TrackingState(*reference);
  T_odom_reference_ = T_odom_hint * state_.T_reference_last().inverse();
  judge_.reset();
  exposures_.forgetFrames();
  const bool untold = reference->exposure && reference->exposure_log_sigma > 0.0;
  if (untold && reference->cause == ReferenceCause::kMapBegins) {
    exposures_.learn(reference->mid_exposure_ns, {*reference->exposure, reference->exposure_log_sigma});
  }
  lost_.find();
}

SE3 FrameTracking::changeReference(const ReferenceConstPtr& reference) {
  SE3 T_new_old = T_newReference_oldReference(*reference);
  state_.changeReference(T_new_old);
  exposures_.changeReference(T_new_old);
  T_odom_reference_ = T_odom_reference_ * T_new_old.inverse();
  reference_ = reference;
  lost_.find();
  return T_new_old;
}

SE3 FrameTracking::recover(const ReferenceConstPtr& reference, const SE3& T_odom_hint) {
  SE3 T_new_old = changeReference(reference);
  state_ = TrackingState(*reference);
  T_odom_reference_ = T_odom_hint * state_.T_reference_last().inverse();
  return T_new_old;
}

void FrameTracking::leave() {
  reference_.reset();
  lost_.find();
}

void FrameTracking::reset() {
  leave();
  judge_.reset();
  exposures_.reset();
  T_odom_camera_ = SE3();
  velocity_ = {};
  T_odom_reference_ = SE3();
}

FrameConstPtr FrameTracking::asKnownNow(const FrameConstPtr& frame) const {
  if (!frame->exposure) return withExposureKnownNow(frame);
  return withExposure(frame, exposures_.exposureFor(frame->exposure, frame->mid_exposure_ns), 0.0);
}

FrameConstPtr FrameTracking::withExposureKnownNow(const FrameConstPtr& frame) const {
  const auto exposure = exposures_.exposureFor(std::nullopt, frame->mid_exposure_ns);
  return withExposure(frame, exposure, exposure ? exposures_.estimate(false, frame->mid_exposure_ns).log_sigma : 0.0);
}

std::shared_ptr<TrackedFrame> FrameTracking::track(const FrameConstPtr& given, const std::optional<CameraTurn>& turn) {
  auto tracked = align(given, turn);
  learnExposure(tracked, given);
  judge_.judge(*tracked, lost_.lost(), secondsBetween(state_, *tracked->frame));
  goOnFrom(*tracked);
  return tracked;
}

std::shared_ptr<TrackedFrame> FrameTracking::leapTo(const FrameConstPtr& given, const std::optional<CameraTurn>& turn) {
  auto tracked = align(given, turn);
  if (tracked->status != TrackingStatus::kTracking) return nullptr;
  learnExposure(tracked, given);
  degrade(*tracked, "frames before it were left out, and no other has confirmed it yet");
  judge_.judge(*tracked, false, 0.0);
  goOnFrom(*tracked);
  return tracked;
}

std::shared_ptr<TrackedFrame> FrameTracking::align(const FrameConstPtr& given,
                                                   const std::optional<CameraTurn>& turn) const {
  const FrameConstPtr frame = asKnownNow(given);
  const TrackingGuess guess = state_.guessFor(*frame, config_.unknown_exposure, turn);
  return std::make_shared<TrackedFrame>(tracker_.track(*reference_, frame, guess));
}

void FrameTracking::learnExposure(const std::shared_ptr<TrackedFrame>& tracked, const FrameConstPtr& given) {
  tracked->exposure_estimate = exposures_.estimate(given->exposure.has_value(), given->mid_exposure_ns);
  exposures_.add(reference_, tracked, given->exposure);
  if (given->exposure) return;
  tracked->exposures = exposures_.history();
  if (tracked->exposure_by_rows) tracked->frame = withExposureKnownNow(tracked->frame);
}

void FrameTracking::goOnFrom(const TrackedFrame& tracked) {
  if (!tracked.tracked()) return lost_.lose(tracked.frame->mid_exposure_ns, false);
  lost_.find();
  state_.update(tracked);
  moveWith(tracked);
}

void FrameTracking::moveWith(const TrackedFrame& tracked) {
  T_odom_camera_ = T_odom_reference_ * tracked.trajectory.T_reference_mid;
  velocity_.add(tracked, T_odom_camera_);
}

std::shared_ptr<TrackedFrame> FrameTracking::trackAhead(const FrameConstPtr& given, TrackingState& newest) {
  const FrameConstPtr frame = asKnownNow(given);
  const TrackingGuess guess = newest.guessFor(*frame, config_.unknown_exposure);
  auto tracked = std::make_shared<TrackedFrame>(tracker_.track(*reference_, frame, guess));
  judge_.judge(*tracked, false, secondsBetween(newest, *frame));
  if (!tracked->tracked()) return nullptr;
  tracked->exposure_estimate = exposures_.estimate(given->exposure.has_value(), given->mid_exposure_ns);
  if (!given->exposure) tracked->exposures = exposures_.history();
  tracked->provisional = true;
  newest.update(*tracked);
  moveWith(*tracked);
  return tracked;
}

double FrameTracking::meanDepth() const {
  double inverse_depths = 0.0;
  for (const ReferencePoint& point : reference_->points) inverse_depths += static_cast<double>(point.inverse_depth);
  return inverse_depths > 0.0 ? static_cast<double>(reference_->points.size()) / inverse_depths : 0.0;
}

std::optional<SE3> FrameTracking::predicted_T_odom_camera(std::int64_t mid_exposure_ns) const {
  if (!reference_ || !lost_.lost()) return std::nullopt;
  return T_odom_reference_ * state_.constantVelocityAt(mid_exposure_ns);
}

SE3 FrameTracking::T_map_odom() const {
  if (!reference_) return {};
  return reference_->T_corrected_map * reference_->T_map_reference * T_odom_reference_.inverse();
}

SE3 FrameTracking::T_newReference_oldReference(const Reference& next) const {
  const auto found = next.T_map_keyframe.find(reference_->id.keyframe_id);
  const SE3 T_map_old = found != next.T_map_keyframe.end() ? found->second : reference_->T_map_reference;
  return next.T_map_reference.inverse() * T_map_old;
}

}  // namespace mba_vo
