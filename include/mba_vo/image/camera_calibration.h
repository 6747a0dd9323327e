#pragma once

#include <string>
#include <vector>

namespace mba_vo {

/// Calibration of a camera in the terms of sensor_msgs/CameraInfo, and with the model `fov` beyond it.
struct CameraCalibration {
  int width = 0;                               // [px]
  int height = 0;                              // [px]
  double fx = 0, fy = 0, cx = 0, cy = 0;       // K [px]
  std::string distortion_model = "plumb_bob";  // ..., rational_polynomial, equidistant, fov; "" = none
  std::vector<double> distortion;              // D
};

/// Throws std::invalid_argument naming the offending value and what is allowed.
void validate(const CameraCalibration& calibration);

/// True if the calibration is that of an ideal pinhole camera, whose images need no rectification.
bool isUndistorted(const CameraCalibration& calibration);

}  // namespace mba_vo
