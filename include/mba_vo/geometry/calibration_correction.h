#pragma once

#include <Eigen/Core>

#include "mba_vo/geometry/pinhole_camera.h"

namespace mba_vo {

/// Small errors of a camera's calibration, to be corrected in rectification. What the calibration takes for an ideal
/// camera's pixel at the normalised coordinates x, of radius r, is the image of
/// x (1 + focal + k1 r^2 + k2 r^4) + centre; one row follows another by `row_time` more than configured.
struct CalibrationCorrection {
  static constexpr int kDim = 6;
  using Vector = Eigen::Matrix<double, kDim, 1>;
  using Matrix = Eigen::Matrix<double, kDim, kDim>;
  enum Index { kFocal, kCentreX, kCentreY, kK1, kK2, kRowTime };

  Vector values = Vector::Zero();  // [1, focal lengths, focal lengths, 1, 1, s], in the order of Index

  double operator[](Index i) const { return values(i); }
  bool operator==(const CalibrationCorrection& o) const { return values == o.values; }
  bool operator!=(const CalibrationCorrection& o) const { return values != o.values; }
  bool isZero() const { return values.isZero(0.0); }
  /// True if the images themselves change.
  bool correctsLens() const { return !values.head<kRowTime>().isZero(0.0); }

  Eigen::Vector2d apply(const Eigen::Vector2d& x) const {
    const double r2 = x.squaredNorm();
    return x * (1.0 + values(kFocal) + r2 * (values(kK1) + r2 * values(kK2))) +
           Eigen::Vector2d(values(kCentreX), values(kCentreY));
  }
};

/// d pixel of the image / d correction, `pixel` being where the ideal camera sees the point; not by the row time.
Eigen::Matrix<double, 2, CalibrationCorrection::kDim> lensJacobian(const PinholeCamera& camera,
                                                                   const Eigen::Vector2d& pixel);

}  // namespace mba_vo
