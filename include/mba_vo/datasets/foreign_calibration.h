#pragma once

#include <ostream>

#include "mba_vo/image/camera_calibration.h"

namespace mba_vo {

/// A calibration in the forms that other systems read. All throw std::invalid_argument naming the lens, and which ones
/// are allowed, where the other system has no such lens. `rate`: of the images [Hz].

/// camera.txt of DSO. Its sides are multiples of 16 after DSO's own rectification, as its pyramid demands.
void writeDsoCamera(const CameraCalibration& calibration, std::ostream& out);

/// sensor.yaml of an ASL folder (EuRoC), of a camera that is the body.
void writeAslCamera(const CameraCalibration& calibration, double rate, std::ostream& out);

/// Settings of ORB-SLAM2 and 3, which ask for different keys, in one file; an equidistant lens only ORB-SLAM3 knows.
/// What is not of the camera is as in the settings that they ship for TUM RGB-D.
void writeOrbSlamSettings(const CameraCalibration& calibration, double rate, std::ostream& out);

}  // namespace mba_vo
