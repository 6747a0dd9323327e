#pragma once

#include <cstddef>
#include <vector>

#include "mba_vo/geometry/calibration_correction.h"
#include "mba_vo/mapping/keyframe_report.h"

namespace mba_vo {

/// How a calibration is to be corrected, as all windows of a run tell together, and how well they know it.
struct CalibrationEstimate {
  CalibrationCorrection correction;  // of the told calibration
  CalibrationCorrection::Matrix covariance = CalibrationCorrection::Matrix::Zero();
  int windows = 0;

  CalibrationCorrection::Vector sigma() const { return covariance.diagonal().cwiseMax(0.0).cwiseSqrt(); }
  /// Of the difference from another correction, as many degrees of freedom as there are numbers.
  double chi2(const CalibrationCorrection& other) const;
};

/// What is known of the camera otherwise.
struct CameraKind {
  bool vignette_told = false;  // there is nothing left of it to be found
  bool rolling = false;        // its shutter
};

/// From the first `count` keyframes. The covariance is that
/// of the residuals, or, where estimates from parts of the run scatter more than that, larger.
CalibrationEstimate estimateCalibration(const std::vector<KeyframeReport>& keyframes, std::size_t count,
                                        const CameraKind& camera);

}  // namespace mba_vo
