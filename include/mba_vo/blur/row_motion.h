#pragma once

#include <array>
#include <optional>
#include <utility>

#include "mba_vo/geometry/body_motion.h"
#include "mba_vo/geometry/pinhole_camera.h"
#include "mba_vo/geometry/se3.h"

namespace mba_vo {

/// A pose as the paths need it: x -> R x + p.
struct RigidMotion {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();

  RigidMotion() = default;
  RigidMotion(Eigen::Matrix3d rotation, Eigen::Vector3d translation)
      : R(std::move(rotation)), p(std::move(translation)) {}
  explicit RigidMotion(const SE3& T) : R(T.rotationMatrix()), p(T.translation()) {}

  RigidMotion operator*(const RigidMotion& o) const;
  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const;
  RigidMotion inverse() const;
};

/// Exp(xi) of the short motions between the rows of a rolling shutter: exact to the fourth order in the angle.
RigidMotion shortMotion(const Vector6& xi);
/// Exp(t v), t [s].
RigidMotion shortMotion(const Vector6& velocity, double t);

/// T Exp(t v + t^2/2 a) for many short times t: a cubic in t.
class MovingPose {
 public:
  MovingPose() : MovingPose(RigidMotion(), BodyMotion()) {}
  MovingPose(const RigidMotion& T, const BodyMotion& motion);
  RigidMotion at(double t) const;

 private:
  using Coefficient = Eigen::Matrix<double, 3, 4>;
  std::array<Coefficient, 4> c_;
};

/// How camera and reference move while their rows are read out: each around the time of its middle row. No matter with
/// a global shutter.
struct RowMotion {
  BodyMotion camera, reference;
};

/// Where and how deep a camera with a rolling shutter sees a point.
struct RollingProjection {
  Eigen::Vector2d pixel;
  double depth;  // at the time of the pixel's row [m]
};

/// `point` in the camera's axes at the time of the middle row. The row decides when the point is seen, and the time
/// where: a fixed point. nullopt if the point is behind the camera.
std::optional<RollingProjection> projectRolling(const PinholeCamera& camera, const BodyMotion& motion,
                                                const Eigen::Vector3d& point);

}  // namespace mba_vo
