#include "mba_vo/mapping/initial_frames.h"

#include "mba_vo/tracking/motion_state.h"
#include "mba_vo/tracking/tracker.h"
#include "mba_vo/trajectory/finite_difference_velocity.h"

namespace mba_vo {
namespace {

constexpr std::size_t kFrames = 4;  // enough parallax steps for depths to be followed along their epipolar lines

/// The reference and what came after it.
std::vector<InitialMap::Pose> posesForwards(const InitialMap& initial) {
  std::vector<InitialMap::Pose> poses = {{initial.reference, SE3()}};
  for (const InitialMap::Pose& pose : initial.poses) {
    if (pose.frame->mid_exposure_ns > initial.reference->mid_exposure_ns) poses.push_back(pose);
  }
  return poses;
}

BodyMotion motionAt(const std::vector<InitialMap::Pose>& poses, std::size_t i) {
  FiniteDifferenceVelocity motion;
  for (std::size_t k = i - 1; k <= i + 1; ++k) {
    motion.add(poses[k].frame->mid_exposure_ns, poses[k].T_reference_frame, std::nullopt);
  }
  return motion.motionOfMiddle();
}

TrackingGuess guessAt(const InitialMap::Pose& pose, const Vector6& velocity, double exposure) {
  const std::int64_t ns = pose.frame->mid_exposure_ns;
  return {MotionState({pose.T_reference_frame, velocity, exposure}, ns).priorAt(ns), exposure};
}

}  // namespace

std::vector<InitialFrame> trackInitialFrames(const MapperConfig& config, const InitialMap& initial,
                                             const Reference& first_keyframe) {
  const std::vector<InitialMap::Pose> poses = posesForwards(initial);
  const Tracker tracker(config.tracker);
  std::vector<InitialFrame> frames;
  AffineBrightness brightness;
  std::size_t last = 0;
  for (std::size_t k = 1; poses.size() > 2 && k <= kFrames; ++k) {
    const std::size_t i = k * (poses.size() - 2) / kFrames;
    if (i == last) continue;
    last = i;
    const FrameConstPtr& frame = poses[i].frame;
    const BodyMotion motion = motionAt(poses, i);
    TrackingGuess guess = guessAt(poses[i], motion.velocity, frame->exposure.value_or(config.tracker.unknown_exposure));
    guess.brightness = brightness;
    const auto tracked = std::make_shared<TrackedFrame>(tracker.track(first_keyframe, frame, guess));
    if (!tracked->tracked()) break;
    brightness = tracked->brightness;
    frames.push_back({tracked, motion});
  }
  return frames;
}

}  // namespace mba_vo
