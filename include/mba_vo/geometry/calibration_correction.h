#pragma once

#include <Eigen/Core>

#include "mba_vo/geometry/pinhole_camera.h"

namespace mba_vo {

/// Small errors of a camera's calibration, to be corrected when images are made. Geometry, in rectification: what the
/// calibration takes for an ideal camera's pixel at the normalised coordinates x, of radius r, is the image of
/// x (1 + focal + k1 r^2 + k2 r^4) + centre; all rows are read out within `readout` more than configured: row r of h
/// follows the one before by readout / h more. Vignette: at q, the squared distance from the principal point over that
/// of the corners, a pixel gets exp(v1 q + v2 q^2 + v3 q^3) of the light that it would get in the middle.
struct CalibrationCorrection {
  static constexpr int kGeometryDim = 6;
  static constexpr int kVignetteDim = 3;
  static constexpr int kDim = kGeometryDim + kVignetteDim;
  using Vector = Eigen::Matrix<double, kDim, 1>;
  using Matrix = Eigen::Matrix<double, kDim, kDim>;
  using Vignette = Eigen::Matrix<double, kVignetteDim, 1>;
  enum Index { kFocal, kCentreX, kCentreY, kK1, kK2, kReadout, kV1, kV2, kV3 };

  Vector values = Vector::Zero();  // [1, focal lengths, focal lengths, 1, 1, s, 1, 1, 1], in the order of Index

  double operator[](Index i) const { return values(i); }
  bool operator==(const CalibrationCorrection& o) const;
  bool operator!=(const CalibrationCorrection& o) const { return !(*this == o); }
  bool isZero() const;
  /// True if pixels are moved.
  bool correctsLens() const;
  bool correctsVignette() const;
  Vignette vignette() const { return values.tail<kVignetteDim>(); }

  /// What is to be added to it to have `wanted`.
  CalibrationCorrection lacks(const CalibrationCorrection& wanted) const;

  Eigen::Vector2d apply(const Eigen::Vector2d& x) const;
};

/// What a pinhole camera can have of a correction: centre, row time, and the focal length that comes nearest to it with
/// the radial distortion, over the image.
CalibrationCorrection pinholePart(const CalibrationCorrection& correction, const PinholeCamera& camera);

/// The camera of an image that lacked a correction; only what a pinhole camera can have of it counts.
PinholeCamera withCorrection(const PinholeCamera& camera, const CalibrationCorrection& lacking);

/// d pixel of the image / d correction, `pixel` being where the ideal camera sees the point; not by the row time.
Eigen::Matrix<double, 2, CalibrationCorrection::kDim> lensJacobian(const PinholeCamera& camera,
                                                                   const Eigen::Vector2d& pixel);

/// Whether images that are made with and without it differ by more than half a pixel in a corner, 2 % of the light or a
/// millisecond from the first row to the last. Right calibrations are corrected by less, now and then.
bool isNoticeable(const CalibrationCorrection& correction, const PinholeCamera& camera);

/// d log of the light that a pixel gets / d vignette.
CalibrationCorrection::Vignette vignetteJacobian(const PinholeCamera& camera, const Eigen::Vector2d& pixel);

/// How the images of a place differ in brightness because each of them was made with a vignette that is not quite
/// right.
class VignetteRatio {
 public:
  /// No difference.
  VignetteRatio() = default;
  /// `lacking`: what is to be added to the correction that the image was made with.
  VignetteRatio(const PinholeCamera& host, const CalibrationCorrection& lacking_host, const PinholeCamera& target,
                const CalibrationCorrection& lacking_target);

  /// Brightness in the target over that in the host.
  double at(const Eigen::Vector2d& host_pixel, const Eigen::Vector2d& target_pixel) const;

 private:
  bool is_one_ = true;
  PinholeCamera host_, target_;
  CalibrationCorrection::Vignette lacking_host_, lacking_target_;
};

}  // namespace mba_vo
