#pragma once

#include <memory>
#include <string>

#include "mba_vo/capture/device_camera.h"

namespace mba_vo {

struct CameraSettings {
  DeviceSettings device;          // its path may be a number (0 = /dev/video0), a device, a file or a folder
  bool loop = false;              // recordings: begin again at the end
  std::string images = "images";  // sequence folders: subfolder of the images
  std::string camera;             // sequence folders: which one of several in the camera file; empty = the first
};

/// Whether the path is that of a device, and not of a recording.
bool isDevice(const std::string& path);

/// Opens a camera, which may then be unplugged and plugged in again, or a recording that is played like one. Throws
/// CameraError.
std::unique_ptr<CameraSource> openCamera(const CameraSettings& settings, const std::shared_ptr<DeviceCalls>& calls,
                                         const std::shared_ptr<Clock>& clock);

}  // namespace mba_vo
