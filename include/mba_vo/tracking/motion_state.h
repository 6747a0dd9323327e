#pragma once

#include <cstdint>

#include "mba_vo/tracking/motion_prior.h"
#include "mba_vo/tracking/tracked_frame.h"

namespace mba_vo {

inline constexpr double kLongestPrediction = 0.15;  // [s] no velocity is trusted further away

/// Keeps the last tracked pose and the motion there, from which the next frame is predicted.
class MotionState {
 public:
  MotionState() = default;
  /// `trajectory` at `mid_exposure_ns`, relative to the reference that tracking begins with.
  MotionState(const ExposureTrajectory& trajectory, std::int64_t mid_exposure_ns)
      : last_(trajectory), last_ns_(mid_exposure_ns) {}

  void update(const TrackedFrame& tracked);
  /// Goes on relative to another reference.
  void changeReference(const SE3& T_new_old) { last_.T_reference_mid = T_new_old * last_.T_reference_mid; }

  /// What is known about a frame at `mid_exposure_ns`, before or after the last one.
  MotionPrior priorAt(std::int64_t mid_exposure_ns) const;

  /// Where the camera would be if it went on moving as it last did.
  SE3 constantVelocityAt(std::int64_t mid_exposure_ns) const {
    return last_.T_reference_mid * SE3::exp(1e-9 * static_cast<double>(mid_exposure_ns - last_ns_) * last_.velocity);
  }

  const ExposureTrajectory& last() const { return last_; }
  std::int64_t lastNs() const { return last_ns_; }

 private:
  ExposureTrajectory last_;  // relative to the reference
  std::int64_t last_ns_ = 0;
  Vector6 acceleration_ = Vector6::Zero();  // body frame [m/s^2, rad/s^2]
};

}  // namespace mba_vo
