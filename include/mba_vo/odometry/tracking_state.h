#pragma once

#include <cstdint>
#include <optional>

#include "mba_vo/tracking/motion_state.h"
#include "mba_vo/tracking/tracker.h"

namespace mba_vo {

/// A rotation of the camera that was measured without the map.
struct CameraTurn {
  Eigen::Quaterniond R_from_to = Eigen::Quaterniond::Identity();
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // at the end of it, camera frame [rad/s]
};

/// What the last tracked frame tells about the next one: motion and brightness.
class TrackingState {
 public:
  TrackingState() = default;
  /// The hint of the reference tells where to begin.
  explicit TrackingState(const Reference& reference);
  /// A motion to begin with; nothing is known about the brightness.
  explicit TrackingState(const MotionState& motion) : motion_(motion) {}

  /// The brightness is expected to be that of the last image, unless the contrast has clearly changed: then a change of
  /// exposure has to be followed.
  /// `turn`: since the last tracked frame, if it is known.
  TrackingGuess guessFor(const Frame& frame, double unknown_exposure,
                         const std::optional<CameraTurn>& turn = std::nullopt) const;
  void update(const TrackedFrame& tracked);
  /// Goes on relative to another reference.
  void changeReference(const SE3& T_new_old) { motion_.changeReference(T_new_old); }

  /// Where the camera would be if it went on moving as it last did.
  SE3 constantVelocityAt(std::int64_t mid_exposure_ns) const { return motion_.constantVelocityAt(mid_exposure_ns); }

  const ExposureTrajectory& last() const { return motion_.last(); }
  const SE3& T_reference_last() const { return motion_.last().T_reference_mid; }
  std::int64_t lastNs() const { return motion_.lastNs(); }

 private:
  AffineBrightness expectedBrightness(double contrast_now) const;

  MotionState motion_;
  AffineBrightness brightness_;  // of the last image, relative to the map
  double contrast_ = 0.0;        // of the last image [grey levels]; 0 = none yet
};

}  // namespace mba_vo
