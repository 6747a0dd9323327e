#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace mba_vo {

/// Tangent vector of SE(3): translation part rho [m] (or [m/s]) first, rotation part phi [rad] (or [rad/s]) second.
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Skew-symmetric matrix with hat(a) b = a x b.
Eigen::Matrix3d hat(const Eigen::Vector3d& a);

/// Rigid-body motion. `T_a_b` maps the coordinates of a point in b to its coordinates in a.
class SE3 {
 public:
  SE3() : rotation_(Eigen::Quaterniond::Identity()), translation_(Eigen::Vector3d::Zero()) {}
  SE3(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation);

  static SE3 exp(const Vector6& xi);
  Vector6 log() const;

  const Eigen::Quaterniond& rotation() const { return rotation_; }
  Eigen::Matrix3d rotationMatrix() const { return rotation_.toRotationMatrix(); }
  const Eigen::Vector3d& translation() const { return translation_; }

  SE3 inverse() const;
  SE3 operator*(const SE3& other) const;
  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const;

  /// Ad with T Exp(x) T^-1 = Exp(Ad x).
  Matrix6 adjoint() const;

 private:
  Eigen::Quaterniond rotation_;
  Eigen::Vector3d translation_;
};

/// J_r(xi) with Exp(xi + d) ~ Exp(xi) Exp(J_r d).
Matrix6 rightJacobian(const Vector6& xi);
/// J_l(xi) with Exp(xi + d) ~ Exp(J_l d) Exp(xi).
Matrix6 leftJacobian(const Vector6& xi);

}  // namespace mba_vo
