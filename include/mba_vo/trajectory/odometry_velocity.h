#pragma once

#include <cstdint>
#include <optional>

#include "mba_vo/trajectory/finite_difference_velocity.h"

namespace mba_vo {

/// How the camera moves in the middle of an exposure, in its own axes, and how well that is known.
struct VelocityEstimate {
  BodyMotion motion;
  Matrix6 covariance = Matrix6::Zero();  // of the velocity [m/s, rad/s]
  /// Of the velocity that the alignment of the image alone has found, with which dead reckoning goes on.
  Matrix6 covariance_by_alignment = Matrix6::Zero();
  double linear_acceleration = 0.0;   // of late, mean square of each axis [m^2/s^4]
  double angular_acceleration = 0.0;  // [rad^2/s^4]
};

/// Covariance of a velocity that nothing has measured.
Matrix6 unmeasuredVelocity();

/// Follows the poses of odometry and tells how fast the camera moves: by its pose and those just before it, which know
/// ways best, and of turns by the blur or the rows as far as the poses allow (FiniteDifferenceVelocity). By the
/// alignment of the image alone where no pose is near.
class OdometryVelocity {
 public:
  /// The next image with a measured pose. One that is not later than the last is ignored.
  void add(const TrackedFrame& tracked, const SE3& T_odom_camera);
  /// Of the last one.
  const VelocityEstimate& last() const { return last_; }

 private:
  void observeAcceleration(const Vector6& velocity, double seconds);
  Matrix6 covarianceByAlignment(const TrackedFrame& tracked, double seconds) const;
  Matrix6 covarianceOf(const TrackedFrame& tracked, double seconds) const;

  FiniteDifferenceVelocity by_poses_;
  std::optional<MapId> map_id_;
  std::int64_t last_ns_ = 0;
  std::int64_t frames_ = 0;  // of this map
  VelocityEstimate last_;
};

}  // namespace mba_vo
