#pragma once

#include <array>

#include "mba_vo/geometry/calibration_correction.h"
#include "mba_vo/window/photometric_residual.h"

namespace mba_vo {

/// Normal equations H x = -b of what the correction of the calibration lacks, for residuals of unit variance.
struct CalibrationSystem {
  CalibrationCorrection::Matrix H = CalibrationCorrection::Matrix::Zero();
  CalibrationCorrection::Vector b = CalibrationCorrection::Vector::Zero();
};

/// Normal equations of one residual in the target's states, the inverse depth, and what both images lack of the
/// correction.
struct CalibrationResidual {
  using Mixed = Eigen::Matrix<double, kKeyframeDim, CalibrationCorrection::kDim>;
  Matrix8 H;
  Vector8 b;
  Mixed H_state_correction;
  CalibrationSystem correction;
  Vector8 H_state_depth;
  CalibrationCorrection::Vector H_correction_depth;
  double H_depth;
  double b_depth;
};

/// `path`: with the derivatives at the current state; `pixel`, in the target, of the point in row `host_row`.
CalibrationResidual assembleCalibration(const PairGeometry& pair, const PatchComparison& comparison,
                                        const PatchPath& path, const Eigen::Vector2d& pixel, double host_row);

/// d place in the host / d geometric correction of both images, at mid-exposure [0] and by the time since then [1].
std::array<Eigen::Matrix<double, 2, CalibrationCorrection::kDim>, 2> calibrationJacobian(const PairGeometry& pair,
                                                                                         const PatchPath& path,
                                                                                         const Eigen::Vector2d& pixel,
                                                                                         double host_row);

}  // namespace mba_vo
