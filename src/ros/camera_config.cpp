#include "mba_vo/ros/camera_config.h"

#include "mba_vo/odometry/config_yaml.h"
#include "mba_vo/ros/node_config.h"

namespace mba_vo {

CameraConfig parseCameraConfig(const YAML::Node& parameters) {
  YAML::Node own(YAML::NodeType::Map);
  for (const auto& entry : parameters) {
    if (!entry.second.IsMap()) own[entry.first.as<std::string>()] = entry.second;
  }
  CameraConfig config;
  readConfig(own, config);
  config.stampReference();
  config.camera.device.exposure.seconds = parseExposure("exposure", config.exposure);
  if (config.camera_info_url.empty()) config.camera.camera = config.calibration_camera;  // the recording's own
  return config;
}

}  // namespace mba_vo
