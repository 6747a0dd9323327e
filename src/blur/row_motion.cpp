#include "mba_vo/blur/row_motion.h"

#include <cmath>
#include <limits>

namespace mba_vo {
namespace {

Eigen::Matrix4d twistMatrix(const Vector6& twist) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
  matrix.topLeftCorner<3, 3>() = hat(twist.tail<3>());
  matrix.topRightCorner<3, 1>() = twist.head<3>();
  return matrix;
}

}  // namespace

RigidMotion RigidMotion::operator*(const RigidMotion& o) const { return {R.lazyProduct(o.R), R.lazyProduct(o.p) + p}; }

Eigen::Vector3d RigidMotion::operator*(const Eigen::Vector3d& x) const { return R.lazyProduct(x) + p; }

RigidMotion RigidMotion::inverse() const { return {R.transpose(), -R.transpose().lazyProduct(p)}; }

RigidMotion shortMotion(const Vector6& xi) {
  const Eigen::Vector3d w = xi.tail<3>();
  const Eigen::Vector3d rho = xi.head<3>();
  const double w2 = w.squaredNorm();
  const double sine = 1.0 - w2 / 6.0;     // sin / angle
  const double cosine = 0.5 - w2 / 24.0;  // (1 - cos) / angle^2
  // [w]_x^2 = w w^T - w^2 I
  const Eigen::Vector3d s = sine * w;
  const Eigen::Vector3d c = cosine * w;
  RigidMotion motion;
  motion.R << 1.0 - c.y() * w.y() - c.z() * w.z(), c.x() * w.y() - s.z(), c.x() * w.z() + s.y(),  //
      c.y() * w.x() + s.z(), 1.0 - c.x() * w.x() - c.z() * w.z(), c.y() * w.z() - s.x(),          //
      c.z() * w.x() - s.y(), c.z() * w.y() + s.x(), 1.0 - c.x() * w.x() - c.y() * w.y();
  motion.p = (1.0 - w2 / 6.0) * rho + c.cross(rho) + (w.dot(rho) / 6.0) * w;
  return motion;
}

RigidMotion shortMotion(const Vector6& velocity, double t) { return shortMotion(t * velocity); }

MovingPose::MovingPose(const RigidMotion& T, const BodyMotion& motion) {
  c_[0] << T.R, T.p;
  for (int i = 1; i < 4; ++i) c_[i].setZero();
  if (motion.velocity.isZero(0.0) && motion.acceleration.isZero(0.0)) return;
  const Eigen::Matrix4d V = twistMatrix(motion.velocity);
  const Eigen::Matrix4d A = twistMatrix(motion.acceleration);
  const Eigen::Matrix4d second = 0.5 * (V * V + A);
  const Eigen::Matrix4d third = V * V * V / 6.0 + 0.25 * (V * A + A * V);
  c_[1] = T.R * V.topRows<3>();
  c_[2] = T.R * second.topRows<3>();
  c_[3] = T.R * third.topRows<3>();
}

RigidMotion MovingPose::at(double t) const {
  const Coefficient pose = c_[0] + t * (c_[1] + t * (c_[2] + t * c_[3]));
  return {pose.leftCols<3>(), pose.col(3)};
}

std::optional<RollingProjection> projectRolling(const PinholeCamera& camera, const BodyMotion& motion,
                                                const Eigen::Vector3d& point) {
  constexpr int kMaxIterations = 4;  // an error shrinks by row_time times the speed of the image, at most 0.1
  constexpr double kClose = 0.02;    // [rows]
  // The point at time t is Exp(-t v - t^2/2 a) point, here as a polynomial in t.
  const auto shift = [](const Vector6& twist, const Eigen::Vector3d& at) -> Eigen::Vector3d {
    return twist.tail<3>().cross(at) + twist.head<3>();
  };
  const Eigen::Vector3d w = motion.velocity.tail<3>();
  const Eigen::Vector3d first = -shift(motion.velocity, point);
  const Eigen::Vector3d turning = -0.5 * w.cross(first);
  const Eigen::Vector3d accelerated = shift(motion.acceleration, point);
  const Eigen::Vector3d second = turning - 0.5 * accelerated;
  const Eigen::Vector3d third =
      -w.cross(turning) / 3.0 + 0.25 * (w.cross(accelerated) - motion.acceleration.tail<3>().cross(first));
  Eigen::Vector3d seen = point;
  double row = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kMaxIterations && seen.z() > 0.0; ++i) {
    const double previous = row;
    row = camera.project(seen).y();
    if (std::abs(row - previous) < kClose) break;
    const double t = camera.rowDelay(row);
    seen = point + t * (first + t * (second + t * third));
  }
  if (seen.z() <= 0.0) return std::nullopt;
  return RollingProjection{camera.project(seen), seen.z()};
}

}  // namespace mba_vo
