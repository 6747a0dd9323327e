#include "mba_vo/io/camera_yaml.h"

#include <stdexcept>

#include <yaml-cpp/yaml.h>

namespace mba_vo {
namespace {

YAML::Node require(const YAML::Node& node, const std::string& key) {
  if (!node.IsMap() || !node[key]) {
    throw std::invalid_argument("'" + key + "' is missing");
  }
  return node[key];
}

template <typename Value>
Value read(const YAML::Node& node, const std::string& key) {
  try {
    return require(node, key).as<Value>();
  } catch (const YAML::Exception&) {
    throw std::invalid_argument("'" + key + "' cannot be understood");
  }
}

CameraCalibration parse(const YAML::Node& root) {
  CameraCalibration calibration;
  calibration.width = read<int>(root, "image_width");
  calibration.height = read<int>(root, "image_height");
  const auto K = read<std::vector<double>>(require(root, "camera_matrix"), "data");
  if (K.size() != 9) {
    throw std::invalid_argument("'camera_matrix' has " + std::to_string(K.size()) + " values, must have 9");
  }
  calibration.fx = K[0];
  calibration.cx = K[2];
  calibration.fy = K[4];
  calibration.cy = K[5];
  calibration.distortion_model = read<std::string>(root, "distortion_model");
  calibration.distortion = read<std::vector<double>>(require(root, "distortion_coefficients"), "data");
  validate(calibration);
  return calibration;
}

}  // namespace

CameraCalibration loadCameraYaml(const std::string& file) {
  try {
    return parse(YAML::LoadFile(file));
  } catch (const YAML::BadFile&) {
    throw std::runtime_error(file + ": cannot be read");
  } catch (const YAML::Exception& error) {
    throw std::runtime_error(file + ": " + error.what());
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(file + ": " + error.what());
  }
}

}  // namespace mba_vo
