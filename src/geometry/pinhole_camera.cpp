#include "mba_vo/geometry/pinhole_camera.h"

namespace mba_vo {

Eigen::Matrix<double, 2, 3> PinholeCamera::projectionJacobian(const Eigen::Vector3d& point) const {
  const double iz = 1.0 / point.z();
  Eigen::Matrix<double, 2, 3> jacobian;
  jacobian << fx * iz, 0.0, -fx * point.x() * iz * iz, 0.0, fy * iz, -fy * point.y() * iz * iz;
  return jacobian;
}

PinholeCamera PinholeCamera::halved() const {
  return {width / 2, height / 2, 0.5 * fx, 0.5 * fy, 0.5 * (cx + 0.5) - 0.5, 0.5 * (cy + 0.5) - 0.5, 2.0 * row_time};
}

}  // namespace mba_vo
