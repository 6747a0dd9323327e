#pragma once

#include <string>

#include <yaml-cpp/yaml.h>

#include "mba_vo/capture/open_camera.h"
#include "mba_vo/ros/conversions.h"

namespace mba_vo {

/// Parameters of the camera node.
struct CameraConfig {
  CameraSettings camera;
  std::string exposure = "auto";
  std::string stamp_reference = "middle";
  std::string frame_id = "camera_optical";
  std::string camera_name = "camera";
  std::string camera_info_url;
  std::string calibration_camera;
  double field_of_view = 0.0;

  CameraConfig() { camera.device.path = "/dev/video0"; }

  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    auto& device = c.camera.device;
    v("device", device.path, "video device or its number, or a video file, image folder or sequence folder");
    v("pixel_format", device.format.pixel_format, "auto, mjpeg, yuyv or grey");
    v("width", device.format.width, 0, 1 << 14, "with height; 0 = next to 640x480 [px]");
    v("height", device.format.height, 0, 1 << 14, "with width [px]");
    v("rate", device.format.rate, 0.0, 1000.0, "0 = next to 30, or the recording's own [Hz]");
    v("color", device.color, "publish bgr8, else mono8");
    v("exposure", c.exposure, "auto, or for all images [s]");
    v("max_exposure", device.exposure.longest, 0.0, 10.0,
      "automatic exposure by this node, never longer, with gain beyond; 0 = by the camera [s]");
    v("dynamic_frame_rate", device.exposure.dynamic_frame_rate,
      "automatic exposure may become longer than images are apart, and the rate lower");
    v("read_out", device.read_out, 0.0, 1.0, "from the first row to the last, 0 = global shutter [s]");
    v("stamp_reference", c.stamp_reference, "what the stamps of the images shall refer to: start, middle or end");
    v("frame_id", c.frame_id, "frame of the images, optical axes");
    v("camera_name", c.camera_name, "of camera_info_manager");
    v("camera_info_url", c.camera_info_url, "calibration: absolute path or URL; empty: where the node keeps it");
    v("calibration_camera", c.calibration_camera, "which one of several cameras of the calibration: cam0, cam1, ...");
    v("field_of_view", c.field_of_view, 0.0, 170.0, "horizontal, where there is no calibration; 0 = unknown [deg]");
    v("loop", c.camera.loop, "recordings begin again at the end");
    v("images", c.camera.images, "subfolder of a sequence folder");
  }

  StampReference stampReference() const { return parseStampReference(stamp_reference); }
};

/// Throws std::invalid_argument naming the key, the value and what is allowed. Sections are not the node's own, but of
/// what publishes for it (image_transport), and passed over.
CameraConfig parseCameraConfig(const YAML::Node& parameters);

}  // namespace mba_vo
