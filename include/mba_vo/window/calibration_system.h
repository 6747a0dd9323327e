#pragma once

#include "mba_vo/geometry/calibration_correction.h"
#include "mba_vo/window/window_linearizer.h"

namespace mba_vo {

/// Normal equations H x = -b of what the correction of the calibration lacks, all poses, depths and brightnesses
/// eliminated; for residuals of unit variance.
struct CalibrationSystem {
  CalibrationCorrection::Matrix H = CalibrationCorrection::Matrix::Zero();
  CalibrationCorrection::Vector b = CalibrationCorrection::Vector::Zero();
};

/// What the residuals of a window, without its prior, say about the calibration of its images: from every `stride`-th
/// point.
CalibrationSystem linearizeCalibration(WindowState& state, const WindowLinearizer& linearizer, int stride);

/// d place in the host / d geometric correction of both images, at mid-exposure [0] and by the time since then [1].
std::array<Eigen::Matrix<double, 2, CalibrationCorrection::kDim>, 2> calibrationJacobian(const PairGeometry& pair,
                                                                                         const PatchPath& path,
                                                                                         const Eigen::Vector2d& pixel,
                                                                                         double host_row);

}  // namespace mba_vo
