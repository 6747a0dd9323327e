#include "mba_vo/io/camera_memory.h"

#include <filesystem>
#include <limits>
#include <stdexcept>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "mba_vo/io/trajectory_writer.h"

namespace mba_vo {
namespace {

using Correction = CalibrationCorrection;

constexpr int kVersion = 2;  // of the file

/// To what camera, and to what told of it, a correction belongs.
YAML::Node describe(const CameraCalibration& c, const FrameBuilderConfig& image) {
  YAML::Node node;
  node["image_width"] = c.width;
  node["image_height"] = c.height;
  node["camera_matrix"] = std::vector<double>{c.fx, c.fy, c.cx, c.cy};
  node["distortion_model"] = c.distortion_model;
  node["distortion_coefficients"] = c.distortion;
  node["row_time"] = image.row_time;
  node["gamma"] = image.gamma;
  node["response_file"] = image.response_file;
  node["vignette_file"] = image.vignette_file;
  return node;
}

std::string textOf(const YAML::Node& node) {
  YAML::Emitter out;
  out.SetDoublePrecision(std::numeric_limits<double>::max_digits10);
  out.SetSeqFormat(YAML::Flow);
  out << node;
  return out.c_str();
}

/// Throws std::runtime_error saying what differs.
void requireSame(const YAML::Node& kept, const YAML::Node& expected) {
  for (const auto& entry : expected) {
    const auto key = entry.first.as<std::string>();
    if (!kept[key]) throw std::runtime_error("'camera." + key + "' is missing");
    const std::string before = textOf(kept[key]);
    const std::string now = textOf(entry.second);
    if (textOf(YAML::Load(before)) == textOf(YAML::Load(now))) continue;
    throw std::runtime_error("it belongs to another camera: " + key + " is " + now + ", there it was " + before +
                             "; give another name or delete the file");
  }
}

CalibrationCorrection read(const YAML::Node& root, const YAML::Node& camera) {
  if (!root.IsMap() || !root["version"] || !root["camera"] || !root["correction"]) {
    throw std::runtime_error("'version', 'camera' or 'correction' is missing");
  }
  if (root["version"].as<int>() != kVersion) {
    throw std::runtime_error("version " + root["version"].as<std::string>() + ", must be " + std::to_string(kVersion));
  }
  requireSame(root["camera"], camera);
  const auto values = root["correction"].as<std::vector<double>>();
  CalibrationCorrection correction;
  if (values.size() != static_cast<std::size_t>(Correction::kDim)) {
    throw std::runtime_error("'correction' has " + std::to_string(values.size()) + " values, must have " +
                             std::to_string(Correction::kDim));
  }
  for (int i = 0; i < Correction::kDim; ++i) correction.values(i) = values[static_cast<std::size_t>(i)];
  if (!correction.values.allFinite()) throw std::runtime_error("'correction' is not finite");
  return correction;
}

}  // namespace

CalibrationCorrection CameraMemory::recall(const CameraCalibration& calibration) {
  const std::lock_guard<std::mutex> lock(mutex_);
  calibration_.reset();
  CalibrationCorrection known;
  const std::string& file = image_.learnt_file;
  if (!file.empty() && std::filesystem::exists(file)) {
    try {
      known = read(YAML::LoadFile(file), describe(calibration, image_));
    } catch (const std::exception& error) {
      throw std::runtime_error(file + ": " + error.what());
    }
  }
  calibration_ = calibration;
  return known;
}

void CameraMemory::keep(const CalibrationCorrection& correction) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (image_.learnt_file.empty() || !calibration_) return;
  YAML::Node root;
  root["version"] = kVersion;
  root["camera"] = describe(*calibration_, image_);
  root["correction"] = std::vector<double>(correction.values.data(), correction.values.data() + Correction::kDim);
  replaceFile(image_.learnt_file, [&](std::ostream& out) {
    out << "# What mba_vo has learnt of this camera. Delete the file to begin anew.\n"
        << "# correction: focal length (relative), centre x, y (focal lengths), k1, k2, time of read-out [s], and the "
           "vignette's\n"
        << "# v1, v2, v3: log of the light = v1 q + v2 q^2 + v3 q^3, q the squared radius, 1 in the corners.\n"
        << textOf(root) << "\n";
  });
}

}  // namespace mba_vo
