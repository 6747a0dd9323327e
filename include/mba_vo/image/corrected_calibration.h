#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "mba_vo/geometry/calibration_correction.h"
#include "mba_vo/image/camera_calibration.h"

namespace mba_vo {

/// Where the camera sees these rays [px].
std::vector<cv::Point2d> projectRays(const CameraCalibration& calibration, const std::vector<cv::Point3d>& rays);

/// The ray, at depth 1, that the pixel of a camera of the model `fov` sees.
cv::Point2d rayOfFovPixel(const CameraCalibration& calibration, const cv::Point2d& pixel);

struct CorrectedCalibration {
  CameraCalibration calibration;
  double error_px = 0.0;  // largest, of what it cannot express of the correction [px]
};

/// A calibration of the same model that is by itself what the other one is with the correction of its lens. One
/// without distortion becomes plumb_bob.
CorrectedCalibration correctedCalibration(const CameraCalibration& calibration,
                                          const CalibrationCorrection& correction);

}  // namespace mba_vo
