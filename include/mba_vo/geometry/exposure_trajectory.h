#pragma once

#include "mba_vo/geometry/body_motion.h"
#include "mba_vo/geometry/se3.h"

namespace mba_vo {

/// Where the camera was while the shutter was open: T(t) = T_reference_mid Exp(t v), t in [-exposure/2, exposure/2]
/// (Eq. 5 of the MBA-VO paper, written about the middle of the exposure, and with acceleration).
struct ExposureTrajectory {
  SE3 T_reference_mid;                     // camera to reference at mid-exposure
  Vector6 velocity = Vector6::Zero();      // body velocity in the camera frame [m/s, rad/s]
  double exposure = 0.0;                   // [s]
  Vector6 acceleration = Vector6::Zero();  // [m/s^2, rad/s^2]

  /// Pose at time t [s] after mid-exposure.
  SE3 at(double t) const { return T_reference_mid * SE3::exp(motionUntil(t)); }
  BodyMotion motion() const { return {velocity, acceleration}; }
  /// Log(T_mid^-1 T(t)).
  Vector6 motionUntil(double t) const { return motion().until(t); }
  SE3 start() const { return at(-0.5 * exposure); }
  SE3 end() const { return at(0.5 * exposure); }
  /// Motion over the whole exposure, Log(T_start^-1 T_end), exact without acceleration [m, rad].
  Vector6 xi() const;
  /// The same motion through an exposure that begins and ends `delay` [s] later, as that of another row of a rolling
  /// shutter. Neglected: that velocity and acceleration do not commute, an error of the third order in time.
  ExposureTrajectory delayed(double delay) const;

  static ExposureTrajectory fromStartAndEnd(const SE3& start, const SE3& end, double exposure);
};

}  // namespace mba_vo
