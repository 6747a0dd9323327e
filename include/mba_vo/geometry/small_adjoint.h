#pragma once

#include "mba_vo/geometry/se3.h"

namespace mba_vo {

/// ad(xi), the derivative of the adjoint: J_r(xi) = I - ad / 2 + ad^2 / 6 - ..., J_l(xi) = I + ad / 2 + ad^2 / 6 + ...
inline Matrix6 smallAdjoint(const Vector6& xi) {
  Matrix6 ad;
  ad << hat(xi.tail<3>()), hat(xi.head<3>()), Eigen::Matrix3d::Zero(), hat(xi.tail<3>());
  return ad;
}

}  // namespace mba_vo
