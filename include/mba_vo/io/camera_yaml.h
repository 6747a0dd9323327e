#pragma once

#include <ostream>
#include <string>

#include "mba_vo/image/camera_calibration.h"

namespace mba_vo {

/// Reads a camera calibration as ROS's camera_calibration writes it (image_width, image_height, camera_matrix,
/// distortion_model, distortion_coefficients). Throws std::runtime_error naming the file and what is wrong.
CameraCalibration loadCameraYaml(const std::string& file);

/// Writes one, all digits kept. A model without a name is plumb_bob.
void writeCameraYaml(const CameraCalibration& calibration, const std::string& camera_name, std::ostream& out);

}  // namespace mba_vo
