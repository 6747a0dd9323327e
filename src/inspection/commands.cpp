#include <algorithm>
#include <cmath>

#include "mba_vo/inspection/inspection_report.h"
#include "mba_vo/inspection/judgements.h"
#include "wording.h"

namespace mba_vo {
namespace {

constexpr const char* kOptionsFile = "options.yaml";

bool has(const CameraReport& camera, Check check) {
  return std::any_of(camera.findings.begin(), camera.findings.end(),
                     [check](const Finding& finding) { return finding.check == check; });
}

/// What exposure to tell for all images; empty = as it is recorded, or estimated.
std::string exposureToTell(const CameraReport& camera) {
  if (has(camera, Check::kExposureZero)) return "";  // there is no better one
  if (!has(camera, Check::kExposureUnit)) return "";
  constexpr double kConstant = 0.02;  // relative
  std::vector<double> known;
  for (const ExposureFacts& exposure : camera.facts.exposures) {
    if (exposure.seconds > 0.0) known.push_back(exposure.seconds);
  }
  const double usual = usualExposure(camera.facts.exposures);
  const auto unit = mistakenUnit(usual, usualInterval(camera.facts.images));
  const bool constant = quantile(known, 1.0) - quantile(known, 0.0) < kConstant * usual;
  return unit && constant ? number(usual * unit->seconds, 6) : "";
}

std::string quoted(const std::string& path) {
  const bool plain = path.find_first_of(" '\"\\$&()*;<>?[]`{|}~#!") == std::string::npos;
  if (plain) return path;
  std::string text = "'";
  for (const char c : path) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

std::string option(const char* name, const std::string& value) {
  return value.empty() ? "" : std::string(" ") + name + quoted(value);
}

std::string baseTopic(const RecordedCamera& source) {
  const std::string suffix = "/compressed";
  const bool ends = source.image.size() > suffix.size() &&
                    source.image.compare(source.image.size() - suffix.size(), suffix.size(), suffix) == 0;
  return source.compressed && ends ? source.image.substr(0, source.image.size() - suffix.size()) : source.image;
}

std::string launchLine(const InspectionReport& report, const CameraReport& camera, bool config) {
  const RecordedCamera& source = camera.source;
  std::string line = "roslaunch mba_vo mba_vo.launch bag:=" + quoted(report.path) + " image:=" + baseTopic(source);
  line += option("camera_info:=", source.camera_info) + option("exposure:=", source.exposure);
  if (source.compressed) line += " image_transport:=compressed";
  line += option("exposure_time:=", exposureToTell(camera));
  if (config) line += std::string(" config:=$PWD/") + kOptionsFile;
  return line + " rviz:=true";
}

}  // namespace

Commands commandsFor(const InspectionReport& report, const CameraReport& camera) {
  Commands commands;
  const RecordedCamera& source = camera.source;
  if (camera.facts.images.empty() || !camera.facts.calibration) return commands;
  if (has(camera, Check::kWhiteLevel)) {
    commands.options_yaml.push_back("white_level: " + number(camera.facts.white_level, 5));
  }
  const auto response = measureResponse(camera.facts);
  if (has(camera, Check::kGamma) && isGamma(response)) {
    commands.options_yaml.push_back("gamma: " + number(1.0 / response->power, 2));
  }
  const bool config = !commands.options_yaml.empty();
  std::string offline = "rosrun mba_vo mba_vo_offline " + quoted(report.path) + " --output output";
  if (source.images_subfolder != "images") offline += option("--images ", source.images_subfolder);
  offline += option("--camera ", source.camera) + option("--calibration ", source.calibration_file);
  offline += option("--image-topic ", source.image) + option("--camera-info-topic ", source.camera_info) +
             option("--exposure-topic ", source.exposure) + option("--exposure ", exposureToTell(camera));
  if (config) offline += std::string(" --config ") + kOptionsFile;
  commands.lines.push_back(offline);
  const bool live = report.is_bag && source.calibration_file.empty();  // nodes read the camera_info of the bag
  if (live) commands.lines.push_back(launchLine(report, camera, config));
  return commands;
}

}  // namespace mba_vo
