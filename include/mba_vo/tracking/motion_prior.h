#pragma once

#include <vector>

#include "mba_vo/geometry/exposure_trajectory.h"

namespace mba_vo {

/// Twice what hands and heads do: stricter for a turn than for a way, the turn is taken for a way
/// (docs/decisions/2026-11-25-motion-prior.md).
struct MotionPriorConfig {
  double angular_acceleration = 10.0;  // standard deviation [rad/s^2]
  double linear_acceleration = 5.0;    // standard deviation [median depths/s^2]

  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    v("angular_acceleration", c.angular_acceleration, 0.01, 1e4, "std. deviation of angular acceleration [rad/s^2]");
    v("linear_acceleration", c.linear_acceleration, 0.01, 1e4,
      "std. deviation of linear acceleration [median scene depths/s^2]");
  }
};

/// What is known about the motion before a frame is looked at: the previous frame's pose and velocity.
struct MotionPrior {
  ExposureTrajectory previous;             // relative to the reference of the coming alignment
  Vector6 acceleration = Vector6::Zero();  // at the previous frame, body frame [m/s^2, rad/s^2]
  double dt = 0.0;                         // from the previous mid-exposure to this one [s]

  /// Constant velocity over dt.
  ExposureTrajectory predict(double exposure) const;
  /// Other poses from which to begin: constant acceleration, half, no, double and reversed motion.
  std::vector<SE3> alternatives() const;

  /// Motion within an exposure of this frame, given its mid pose. By the trapezoid rule the mean velocity between the
  /// two frames is the mean of their velocities, which also tells the sign at a reversal.
  Vector6 expectedXi(const SE3& T_reference_mid, double exposure) const;

  /// What motion `xi` within an exposure at T_mid says of the acceleration there, times the square of the exposure: the
  /// velocity exceeds the mean since the previous frame by what half the time between them adds.
  Vector6 bend(const SE3& T_reference_mid, const Vector6& xi, double exposure) const;

  /// Diagonal information of T_mid about the prediction, and of xi about expectedXi [1/rad^2, 1/m^2].
  Vector6 poseInformation(const MotionPriorConfig& config, double median_depth) const;
  /// `doubt`: standard deviations of the latter besides, as of an exposure that nobody told [m, rad].
  Vector6 xiInformation(const MotionPriorConfig& config, double median_depth, double exposure,
                        const Vector6& doubt) const;
};

}  // namespace mba_vo
