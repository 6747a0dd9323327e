#include "mba_vo/mapping/replay.h"

#include <algorithm>

#include "mba_vo/mapping/kinematic_blur.h"

namespace mba_vo {

Vector6 referenceVelocity(const InitialMap& initial) {
  const std::int64_t origin_ns = initial.reference->mid_exposure_ns;
  const InitialMap::Pose* before = nullptr;
  const InitialMap::Pose* after = nullptr;
  for (const InitialMap::Pose& pose : initial.poses) {  // by time
    if (pose.frame->mid_exposure_ns < origin_ns) before = &pose;
    if (pose.frame->mid_exposure_ns > origin_ns && !after) after = &pose;
  }
  KinematicBlur motion;
  if (before) motion.add(before->frame->mid_exposure_ns, before->T_reference_frame);
  motion.add(origin_ns, SE3());
  if (after) motion.add(after->frame->mid_exposure_ns, after->T_reference_frame);
  return motion.xiOfMiddle(1.0);
}

Replay::Replay(const MapperConfig& config, const InitialMap& initial, const MotionState& start)
    : tracker_(config.tracker), unknown_exposure_(config.tracker.unknown_exposure), initial_(initial), motion_(start) {}

TrackingGuess Replay::guessFor(const FrameConstPtr& frame) const {
  TrackingGuess guess(motion_.priorAt(frame->mid_exposure_ns), frame->exposure.value_or(unknown_exposure_));
  guess.brightness = brightness_;
  const auto same = [&](const InitialMap::Pose& pose) { return pose.frame->sequence == frame->sequence; };
  const auto known = std::find_if(initial_.poses.begin(), initial_.poses.end(), same);
  if (known != initial_.poses.end()) {
    guess.trajectory.T_reference_mid = T_reference_initial_ * known->T_reference_frame;
  }
  return guess;
}

TrackedFrame Replay::track(const Reference& reference, const FrameConstPtr& frame) {
  TrackedFrame tracked = tracker_.track(reference, frame, guessFor(frame));
  if (tracked.tracked()) {
    motion_.update(tracked);
    brightness_ = tracked.brightness;
  }
  return tracked;
}

void Replay::changeReference(const SE3& T_new_old) {
  motion_.changeReference(T_new_old);
  T_reference_initial_ = T_new_old * T_reference_initial_;
}

}  // namespace mba_vo
