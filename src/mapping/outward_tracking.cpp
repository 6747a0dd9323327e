#include "mba_vo/mapping/outward_tracking.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "mba_vo/tracking/frame_measures.h"
#include "mba_vo/trajectory/finite_difference_velocity.h"

namespace mba_vo {
namespace {

constexpr double kLeastVisible = 0.35;    // share of a keyframe's points; with fewer, poses slide, but those ...
constexpr double kWellKnown = 0.3;        // ... known this well [px] (docs/decisions/2026-11-29-before-the-map.md)
constexpr double kMostErrorRatio = 1.25;  // by which more error may be expected of a pose by a nearer keyframe

}  // namespace

TrackingHint newestOf(const InitialMap& initial, const ExposureTrajectory& start) {
  const FrameConstPtr& reference = initial.reference;
  // A map of measured depths begins with the first images.
  if (initial.metric || initial.poses.empty() ||
      initial.poses.back().frame->mid_exposure_ns <= reference->mid_exposure_ns) {
    return {reference->sequence, reference->mid_exposure_ns, start};
  }
  FiniteDifferenceVelocity motion;
  if (initial.poses.size() > 1) {
    const InitialMap::Pose& before = *std::prev(initial.poses.end(), 2);
    motion.add(before.frame->mid_exposure_ns, before.T_reference_frame, std::nullopt);
  }
  const InitialMap::Pose& newest = initial.poses.back();
  motion.add(newest.frame->mid_exposure_ns, newest.T_reference_frame, std::nullopt);
  return {newest.frame->sequence,
          newest.frame->mid_exposure_ns,
          {newest.T_reference_frame, motion.motionOfLast().velocity, newest.frame->exposure.value_or(start.exposure)}};
}

TrackedFrameConstPtr referenceItself(const Reference& reference, const FrameConstPtr& frame,
                                     const ExposureTrajectory& trajectory) {
  auto tracked = std::make_shared<TrackedFrame>();
  tracked->frame = frame;
  tracked->status = TrackingStatus::kTracking;
  tracked->reference = reference.id;
  tracked->trajectory = trajectory;
  return tracked;
}

bool isSeenWell(const TrackedFrame& tracked) {
  return tracked.status == TrackingStatus::kTracking &&
         (tracked.measures.visible_fraction >= kLeastVisible || tracked.expected_error <= kWellKnown);
}

OutwardTracking::OutwardTracking(const MapperConfig& config, std::shared_ptr<const InitialMap> initial,
                                 const MotionState& start, std::deque<FrameConstPtr> frames,
                                 const ReferenceConstPtr& first_keyframe)
    : tracker_(config.tracker),
      policy_(config.keyframe),
      unknown_exposure_(config.tracker.unknown_exposure),
      initial_(std::move(initial)),
      frames_(std::move(frames)),
      keyframes_{{first_keyframe->id.keyframe_id, first_keyframe}},
      keyframe_(first_keyframe->id.keyframe_id),
      motion_(start) {}

void OutwardTracking::update(const std::vector<ReferenceConstPtr>& keyframes) {
  for (const ReferenceConstPtr& keyframe : keyframes) keyframes_[keyframe->id.keyframe_id] = keyframe;
}

TrackingGuess OutwardTracking::guessFor(const Frame& frame, const Reference& keyframe) const {
  const SE3 T_keyframe_map = keyframe.T_map_reference.inverse();
  MotionState motion = motion_;
  motion.changeReference(T_keyframe_map * keyframes_.at(keyframe_)->T_map_reference);
  TrackingGuess guess(motion.priorAt(frame.mid_exposure_ns), frame.exposure.value_or(unknown_exposure_));
  guess.brightness = brightness_;
  const auto same = [&](const InitialMap::Pose& pose) { return pose.frame->sequence == frame.sequence; };
  const auto known = std::find_if(initial_->poses.begin(), initial_->poses.end(), same);
  if (known != initial_->poses.end()) {
    const SE3& T_map_first = keyframes_.begin()->second->T_map_reference;
    guess.trajectory.T_reference_mid = T_keyframe_map * T_map_first * known->T_reference_frame;
  }
  return guess;
}

ReferenceConstPtr OutwardTracking::nearestTo(const SE3& T_map_camera) const {
  ReferenceConstPtr nearest;
  double least_need = 0.0;
  for (const auto& [id, keyframe] : keyframes_) {
    const SE3 T_keyframe_camera = keyframe->T_map_reference.inverse() * T_map_camera;
    const FrameMeasures measures = measureFrame(*keyframe, {T_keyframe_camera, Vector6::Zero(), 0.0});
    const double need = policy_.need(*keyframe, measures, brightness_);
    if (nearest && need >= least_need) continue;
    least_need = need;
    nearest = keyframe;
  }
  return nearest;
}

TrackedFrame OutwardTracking::track(const FrameConstPtr& frame) {
  const Reference& last = *keyframes_.at(keyframe_);
  const TrackingGuess guess = guessFor(*frame, last);
  TrackedFrame tracked = tracker_.track(last, frame, guess);
  const ExposureTrajectory& there = tracked.tracked() ? tracked.trajectory : guess.trajectory;
  const ReferenceConstPtr nearest = nearestTo(last.T_map_reference * there.T_reference_mid);
  if (nearest->id.keyframe_id == keyframe_) return tracked;
  TrackedFrame again = tracker_.track(*nearest, frame, guessFor(*frame, *nearest));
  const bool better = !tracked.tracked() || again.expected_error <= kMostErrorRatio * tracked.expected_error;
  if (!again.tracked() || !better) return tracked;
  motion_.changeReference(nearest->T_map_reference.inverse() * last.T_map_reference);
  keyframe_ = nearest->id.keyframe_id;
  return again;
}

std::optional<TrackedFrame> OutwardTracking::next() {
  const FrameConstPtr frame = std::move(frames_.front());
  frames_.pop_front();
  TrackedFrame tracked = track(frame);
  if (!isSeenWell(tracked)) {
    frames_.clear();
    return std::nullopt;
  }
  motion_.update(tracked);
  brightness_ = tracked.brightness;
  return tracked;
}

}  // namespace mba_vo
