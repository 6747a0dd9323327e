#include "mba_vo/io/camera_yaml.h"

#include <iomanip>
#include <limits>
#include <stdexcept>
#include <vector>

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

void writeMatrix(const char* name, int rows, const std::vector<double>& data, std::ostream& out) {
  const std::size_t columns = data.size() / static_cast<std::size_t>(rows);
  out << name << ":\n  rows: " << rows << "\n  cols: " << columns << "\n  data: [";
  for (std::size_t i = 0; i < data.size(); ++i) out << (i > 0 ? ", " : "") << data[i];
  out << "]\n";
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

void writeCameraYaml(const CameraCalibration& c, const std::string& camera_name, std::ostream& out) {
  const std::vector<double> distortion = c.distortion.empty() ? std::vector<double>(5, 0.0) : c.distortion;
  out << std::setprecision(std::numeric_limits<double>::max_digits10) << "image_width: " << c.width
      << "\nimage_height: " << c.height << "\ncamera_name: " << camera_name << "\n";
  writeMatrix("camera_matrix", 3, {c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0}, out);
  out << "distortion_model: " << (c.distortion_model.empty() ? "plumb_bob" : c.distortion_model) << "\n";
  writeMatrix("distortion_coefficients", 1, distortion, out);
  writeMatrix("rectification_matrix", 3, {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}, out);
  writeMatrix("projection_matrix", 3, {c.fx, 0.0, c.cx, 0.0, 0.0, c.fy, c.cy, 0.0, 0.0, 0.0, 1.0, 0.0}, out);
}

}  // namespace mba_vo
