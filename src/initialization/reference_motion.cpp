#include "mba_vo/initialization/reference_motion.h"

#include <array>
#include <memory>
#include <optional>
#include <utility>

#include "mba_vo/tracking/motion_state.h"
#include "mba_vo/trajectory/finite_difference_velocity.h"

namespace mba_vo {
namespace {

constexpr int kTrackingRounds = 2;  // what the neighbours say of their motion depends on that of the reference

/// The image before the reference and the one after it.
using Neighbours = std::array<const InitialMap::Pose*, 2>;

struct Neighbour {
  SE3 T_reference_frame;
  std::optional<ObservedMotion> measured;
};

Neighbours neighboursOf(const InitialMap& initial) {
  const std::int64_t origin_ns = initial.reference->mid_exposure_ns;
  Neighbours neighbours{};
  for (const InitialMap::Pose& pose : initial.poses) {  // by time
    if (pose.frame->mid_exposure_ns < origin_ns) neighbours[0] = &pose;
    if (pose.frame->mid_exposure_ns > origin_ns && !neighbours[1]) neighbours[1] = &pose;
  }
  return neighbours;
}

/// `measure`: what is known of a neighbour.
template <typename Measure>
std::optional<BodyMotion> motionBetween(const InitialMap& initial, const std::optional<ObservedMotion>& own,
                                        const Measure& measure) {
  const auto [before, after] = neighboursOf(initial);
  FiniteDifferenceVelocity motion;
  const auto add = [&](const InitialMap::Pose* pose) {
    if (!pose) return true;
    const std::optional<Neighbour> neighbour = measure(*pose);
    if (neighbour) motion.add(pose->frame->mid_exposure_ns, neighbour->T_reference_frame, neighbour->measured);
    return neighbour.has_value();
  };
  if (!add(before)) return std::nullopt;
  motion.add(initial.reference->mid_exposure_ns, SE3(), own);
  if (!add(after)) return std::nullopt;
  return motion.motionOfMiddle();
}

std::optional<BodyMotion> trackedMotion(const InitialMap& initial, const BodyMotion& motion,
                                        const TrackerConfig& config) {
  const Reference reference = initialReference(initial, motion);
  const Tracker tracker(config);
  const auto track = [&](const InitialMap::Pose& pose) -> std::optional<Neighbour> {
    const double exposure = pose.frame->exposure.value_or(config.unknown_exposure);
    const MotionState state({SE3(), motion.velocity, exposure}, initial.reference->mid_exposure_ns);
    TrackingGuess guess(state.priorAt(pose.frame->mid_exposure_ns), exposure);
    guess.trajectory.T_reference_mid = pose.T_reference_frame;
    guess.is_close = true;
    const TrackedFrame tracked = tracker.track(reference, pose.frame, guess);
    if (!tracked.tracked()) return std::nullopt;
    return Neighbour{tracked.trajectory.T_reference_mid, observedMotion(tracked)};
  };
  return motionBetween(initial, ObservedMotion{motion.velocity, std::nullopt}, track);
}

}  // namespace

Reference initialReference(const InitialMap& initial, const BodyMotion& motion) {
  Reference reference;
  reference.pyramid = std::shared_ptr<const ImagePyramid>(initial.reference, &initial.reference->pyramid);
  reference.points = initial.points;
  reference.image_correction = reference.correction = initial.reference->correction;
  reference.motion = motion;
  return reference;
}

BodyMotion referenceMotion(const InitialMap& initial, const TrackerConfig& config) {
  const auto known = [](const InitialMap::Pose& pose) { return Neighbour{pose.T_reference_frame, std::nullopt}; };
  BodyMotion motion = motionBetween(initial, std::nullopt, known).value_or(BodyMotion());
  const ImagePyramid& pyramid = initial.reference->pyramid;
  const bool rolling = pyramid.levels() > 0 && pyramid.level(0).camera.row_time != 0.0;
  for (int round = 0; rolling && round < kTrackingRounds; ++round) {
    const auto tracked = trackedMotion(initial, motion, config);
    if (!tracked) break;
    motion = *tracked;
  }
  return motion;
}

}  // namespace mba_vo
