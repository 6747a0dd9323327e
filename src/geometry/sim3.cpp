#include "mba_vo/geometry/sim3.h"

#include <cmath>

namespace mba_vo {
namespace {

SE3 turn(const Eigen::Vector3d& phi) {
  Vector6 xi = Vector6::Zero();
  xi.tail<3>() = phi;
  return SE3::exp(xi);
}

}  // namespace

Sim3 Sim3::fromIncrement(const Vector7& v) {
  return Sim3(SE3(turn(v.segment<3>(3)).rotation(), v.head<3>()), std::exp(v(6)));
}

Vector7 Sim3::increment() const {
  Vector7 v;
  v << translation(), SE3(rotation(), Eigen::Vector3d::Zero()).log().tail<3>(), std::log(scale_);
  return v;
}

Sim3 Sim3::inverse() const {
  const Eigen::Quaterniond back = rotation().conjugate();
  return Sim3(SE3(back, -(back * translation()) / scale_), 1.0 / scale_);
}

Sim3 Sim3::operator*(const Sim3& other) const {
  return Sim3(SE3(rotation() * other.rotation(), *this * other.translation()), scale_ * other.scale_);
}

Eigen::Vector3d Sim3::operator*(const Eigen::Vector3d& point) const {
  return scale_ * (T_.rotation() * point) + T_.translation();
}

}  // namespace mba_vo
