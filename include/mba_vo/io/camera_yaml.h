#pragma once

#include <ostream>
#include <string>

#include "mba_vo/image/camera_calibration.h"

namespace mba_vo {

/// Writes a calibration as ROS's camera_calibration does, all digits kept. A model without a name is plumb_bob.
void writeCameraYaml(const CameraCalibration& calibration, const std::string& camera_name, std::ostream& out);

}  // namespace mba_vo
