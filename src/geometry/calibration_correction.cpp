#include "mba_vo/geometry/calibration_correction.h"

namespace mba_vo {

Eigen::Matrix<double, 2, CalibrationCorrection::kDim> lensJacobian(const PinholeCamera& camera,
                                                                   const Eigen::Vector2d& pixel) {
  const double x = (pixel.x() - camera.cx) / camera.fx;
  const double y = (pixel.y() - camera.cy) / camera.fy;
  const double r2 = x * x + y * y;
  Eigen::Matrix<double, 2, CalibrationCorrection::kDim> J;
  J << x, 1.0, 0.0, x * r2, x * r2 * r2, 0.0,  //
      y, 0.0, 1.0, y * r2, y * r2 * r2, 0.0;
  J.row(0) *= camera.fx;
  J.row(1) *= camera.fy;
  return J;
}

}  // namespace mba_vo
