#include "mba_vo/geometry/se3.h"

#include <cmath>

namespace mba_vo {
namespace {

constexpr double kSmallAngle = 1e-4;  // [rad], below it Taylor series are exact to double precision

struct SO3Coefficients {
  double a;  // (1 - cos θ) / θ²
  double b;  // (θ - sin θ) / θ³
};

SO3Coefficients coefficients(double theta) {
  const double t2 = theta * theta;
  if (theta < kSmallAngle) return {0.5 - t2 / 24.0, 1.0 / 6.0 - t2 / 120.0};
  return {(1.0 - std::cos(theta)) / t2, (theta - std::sin(theta)) / (t2 * theta)};
}

Eigen::Matrix3d leftJacobianSO3(const Eigen::Vector3d& phi) {
  const SO3Coefficients c = coefficients(phi.norm());
  const Eigen::Matrix3d p = hat(phi);
  return Eigen::Matrix3d::Identity() + c.a * p + c.b * p * p;
}

Eigen::Matrix3d leftJacobianInverseSO3(const Eigen::Vector3d& phi) {
  const double theta = phi.norm();
  const Eigen::Matrix3d p = hat(phi);
  const double half = 0.5 * theta;
  const double c = theta < kSmallAngle ? 1.0 / 12.0 + theta * theta / 720.0
                                       : (1.0 - half * std::cos(half) / std::sin(half)) / (theta * theta);
  return Eigen::Matrix3d::Identity() - 0.5 * p + c * p * p;
}

Eigen::Quaterniond expSO3(const Eigen::Vector3d& phi) {
  const double theta = phi.norm();
  const double half = 0.5 * theta;
  const double s = theta < kSmallAngle ? 0.5 - theta * theta / 48.0 : std::sin(half) / theta;
  return Eigen::Quaterniond(std::cos(half), s * phi.x(), s * phi.y(), s * phi.z());
}

Eigen::Vector3d logSO3(const Eigen::Quaterniond& rotation) {
  // The two quaternions of a rotation differ in sign; the one with w >= 0 has the smaller angle.
  const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;
  const double w = sign * rotation.w();
  const Eigen::Vector3d v = sign * rotation.vec();
  const double n = v.norm();
  const double scale = n < kSmallAngle ? 2.0 / w - 2.0 * n * n / (3.0 * w * w * w) : 2.0 * std::atan2(n, w) / n;
  return scale * v;
}

/// Coupling block Q of the left Jacobian (Barfoot, State Estimation for Robotics, Eq. 7.86).
Eigen::Matrix3d couplingBlock(const Eigen::Vector3d& rho, const Eigen::Vector3d& phi) {
  const double t = phi.norm();
  const double t2 = t * t;
  double c1 = 1.0 / 6.0;
  double c2 = 1.0 / 24.0;
  double c3 = 1.0 / 120.0;
  if (t > 1e-2) {
    c1 = (t - std::sin(t)) / (t2 * t);
    c2 = (t2 + 2.0 * std::cos(t) - 2.0) / (2.0 * t2 * t2);
    c3 = (2.0 * t - 3.0 * std::sin(t) + t * std::cos(t)) / (2.0 * t2 * t2 * t);
  } else {
    c1 -= t2 / 120.0;
    c2 -= t2 / 720.0;
    c3 -= t2 / 2520.0;
  }
  const Eigen::Matrix3d r = hat(rho);
  const Eigen::Matrix3d p = hat(phi);
  const Eigen::Matrix3d pr = p * r;
  const Eigen::Matrix3d rp = r * p;
  const Eigen::Matrix3d prp = pr * p;
  return 0.5 * r + c1 * (pr + rp + prp) + c2 * (p * pr + rp * p - 3.0 * prp) + c3 * (prp * p + p * prp);
}

}  // namespace

Eigen::Matrix3d hat(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return m;
}

SE3::SE3(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation)
    : rotation_(rotation.normalized()), translation_(translation) {}

SE3 SE3::exp(const Vector6& xi) {
  const Eigen::Vector3d phi = xi.tail<3>();
  return SE3(expSO3(phi), leftJacobianSO3(phi) * xi.head<3>());
}

Vector6 SE3::log() const {
  const Eigen::Vector3d phi = logSO3(rotation_);
  Vector6 xi;
  xi << leftJacobianInverseSO3(phi) * translation_, phi;
  return xi;
}

SE3 SE3::inverse() const {
  const Eigen::Quaterniond inverse_rotation = rotation_.conjugate();
  return SE3(inverse_rotation, -(inverse_rotation * translation_));
}

SE3 SE3::operator*(const SE3& other) const {
  return SE3(rotation_ * other.rotation_, rotation_ * other.translation_ + translation_);
}

Eigen::Vector3d SE3::operator*(const Eigen::Vector3d& point) const { return rotation_ * point + translation_; }

Matrix6 SE3::adjoint() const {
  const Eigen::Matrix3d r = rotationMatrix();
  Matrix6 ad;
  ad << r, hat(translation_) * r, Eigen::Matrix3d::Zero(), r;
  return ad;
}

Matrix6 leftJacobian(const Vector6& xi) {
  const Eigen::Vector3d rho = xi.head<3>();
  const Eigen::Vector3d phi = xi.tail<3>();
  const Eigen::Matrix3d j = leftJacobianSO3(phi);
  Matrix6 jacobian;
  jacobian << j, couplingBlock(rho, phi), Eigen::Matrix3d::Zero(), j;
  return jacobian;
}

Matrix6 rightJacobian(const Vector6& xi) { return leftJacobian(-xi); }

}  // namespace mba_vo
