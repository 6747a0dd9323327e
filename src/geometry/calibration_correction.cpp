#include "mba_vo/geometry/calibration_correction.h"

#include <algorithm>
#include <cmath>

namespace mba_vo {
namespace {

constexpr double kNoticeableShift = 0.5;     // [px]
constexpr double kNoticeableLight = 0.02;    // of its logarithm
constexpr double kNoticeableReadout = 1e-3;  // [s]
constexpr int kGrid = 8;                     // of places in the image, that stand for all
constexpr double kNothing = 1e-9;            // what rounding leaves of a correction, in its units

}  // namespace

bool CalibrationCorrection::operator==(const CalibrationCorrection& o) const { return values == o.values; }

bool CalibrationCorrection::isZero() const { return values.isZero(0.0); }

bool CalibrationCorrection::correctsLens() const { return !values.head<kReadout>().isZero(0.0); }

bool CalibrationCorrection::correctsVignette() const { return !vignette().isZero(0.0); }

CalibrationCorrection CalibrationCorrection::lacks(const CalibrationCorrection& wanted) const {
  return {wanted.values - values};
}

Eigen::Vector2d CalibrationCorrection::apply(const Eigen::Vector2d& x) const {
  const double r2 = x.squaredNorm();
  return x * (1.0 + values(kFocal) + r2 * (values(kK1) + r2 * values(kK2))) +
         Eigen::Vector2d(values(kCentreX), values(kCentreY));
}

bool isNoticeable(const CalibrationCorrection& correction, const PinholeCamera& camera) {
  const Eigen::Vector2d shift = lensJacobian(camera, Eigen::Vector2d::Zero()) * correction.values;
  const double in_corner = correction.vignette().sum();
  const double halfway = correction.vignette().dot(CalibrationCorrection::Vignette(0.5, 0.25, 0.125));
  return shift.norm() > kNoticeableShift || std::max(std::abs(in_corner), std::abs(halfway)) > kNoticeableLight ||
         std::abs(correction[CalibrationCorrection::kReadout]) > kNoticeableReadout;
}

CalibrationCorrection pinholePart(const CalibrationCorrection& correction, const PinholeCamera& camera) {
  CalibrationCorrection part;
  for (const auto i :
       {CalibrationCorrection::kCentreX, CalibrationCorrection::kCentreY, CalibrationCorrection::kReadout}) {
    part.values(i) = correction[i];
  }
  double squares = 0.0;
  double radial = 0.0;  // by least squares of the shift of pixels
  for (int row = 0; row < kGrid; ++row) {
    for (int column = 0; column < kGrid; ++column) {
      const Eigen::Vector3d ray =
          camera.unproject({(column + 0.5) / kGrid * camera.width - 0.5, (row + 0.5) / kGrid * camera.height - 0.5});
      const double r2 = ray.head<2>().squaredNorm();
      squares += r2;
      radial += r2 * r2 * (correction[CalibrationCorrection::kK1] + r2 * correction[CalibrationCorrection::kK2]);
    }
  }
  part.values(CalibrationCorrection::kFocal) = correction[CalibrationCorrection::kFocal] + radial / squares;
  return part.values.isZero(kNothing) ? CalibrationCorrection() : part;
}

PinholeCamera withCorrection(const PinholeCamera& camera, const CalibrationCorrection& lacking) {
  PinholeCamera corrected = camera;
  corrected.cx += camera.fx * lacking[CalibrationCorrection::kCentreX];
  corrected.cy += camera.fy * lacking[CalibrationCorrection::kCentreY];
  corrected.fx *= 1.0 + lacking[CalibrationCorrection::kFocal];
  corrected.fy *= 1.0 + lacking[CalibrationCorrection::kFocal];
  corrected.row_time += lacking[CalibrationCorrection::kReadout] / camera.height;
  return corrected;
}

Eigen::Matrix<double, 2, CalibrationCorrection::kDim> lensJacobian(const PinholeCamera& camera,
                                                                   const Eigen::Vector2d& pixel) {
  const double x = (pixel.x() - camera.cx) / camera.fx;
  const double y = (pixel.y() - camera.cy) / camera.fy;
  const double r2 = x * x + y * y;
  Eigen::Matrix<double, 2, CalibrationCorrection::kDim> J;
  J.setZero();
  J.leftCols<CalibrationCorrection::kReadout>() << x, 1.0, 0.0, x * r2, x * r2 * r2,  //
      y, 0.0, 1.0, y * r2, y * r2 * r2;
  J.row(0) *= camera.fx;
  J.row(1) *= camera.fy;
  return J;
}

CalibrationCorrection::Vignette vignetteJacobian(const PinholeCamera& camera, const Eigen::Vector2d& pixel) {
  const double corner2 = 0.25 * (camera.width * camera.width + camera.height * camera.height);
  const double q = (pixel - Eigen::Vector2d(camera.cx, camera.cy)).squaredNorm() / corner2;
  return {q, q * q, q * q * q};
}

VignetteRatio::VignetteRatio(const PinholeCamera& host, const CalibrationCorrection& lacking_host,
                             const PinholeCamera& target, const CalibrationCorrection& lacking_target)
    : is_one_(lacking_host.vignette().isZero(0.0) && lacking_target.vignette().isZero(0.0)),
      host_(host),
      target_(target),
      lacking_host_(lacking_host.vignette()),
      lacking_target_(lacking_target.vignette()) {}

double VignetteRatio::at(const Eigen::Vector2d& host_pixel, const Eigen::Vector2d& target_pixel) const {
  if (is_one_) return 1.0;
  return std::exp(lacking_target_.dot(vignetteJacobian(target_, target_pixel)) -
                  lacking_host_.dot(vignetteJacobian(host_, host_pixel)));
}

}  // namespace mba_vo
