#include "mba_vo/mapping/initial_frames.h"

#include "mba_vo/tracking/motion_state.h"
#include "mba_vo/tracking/tracker.h"

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

Vector6 velocityBetween(const InitialMap::Pose& before, const InitialMap::Pose& after) {
  const double seconds = after.frame->midExposureSeconds() - before.frame->midExposureSeconds();
  return (before.T_reference_frame.inverse() * after.T_reference_frame).log() / seconds;
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
    const Vector6 velocity = velocityBetween(poses[i - 1], poses[i + 1]);
    TrackingGuess guess = guessAt(poses[i], velocity, frame->exposure.value_or(config.tracker.unknown_exposure));
    guess.brightness = brightness;
    const auto tracked = std::make_shared<TrackedFrame>(tracker.track(first_keyframe, frame, guess));
    if (!tracked->tracked()) break;
    brightness = tracked->brightness;
    frames.push_back({tracked, velocity});
  }
  return frames;
}

}  // namespace mba_vo
