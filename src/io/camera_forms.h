#pragma once

#include <cstddef>
#include <string>

#include "mba_vo/io/camera_file.h"
#include "yaml_fields.h"

namespace mba_vo {

constexpr std::size_t kMostCalibrationBytes = 1U << 20U;  // of a file

/// A YAML file: of ROS, Kalibr or an ASL folder.
CameraFile readCameraYaml(const YamlFields& root, const std::string& file, const std::string& camera);
/// A file of ROS in the form of an INI file.
CameraFile readCameraIni(const std::string& text, const std::string& file);
/// camera.txt of TUM-mono, or four numbers.
CameraFile readCameraText(const std::string& text, const std::string& file, cv::Size image_size);

/// Throws std::runtime_error naming the file for a calibration that is impossible.
void requireValid(const CameraCalibration& calibration, const std::string& where);

}  // namespace mba_vo
