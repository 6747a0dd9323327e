#include "mba_vo/capture/open_camera.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "mba_vo/capture/reconnecting_camera.h"
#include "mba_vo/capture/recording_player.h"

namespace mba_vo {
namespace {

bool isNumber(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

std::unique_ptr<CameraSource> openPlayer(const CameraSettings& settings, const std::shared_ptr<Clock>& clock) {
  const DeviceSettings& device = settings.device;
  if (device.exposure.seconds) {
    throw CameraError(device.path +
                      ": the exposure of a recording cannot be set; tell it to the odometry (exposure_time)");
  }
  if (device.format.width > 0 || device.format.height > 0 || device.format.pixel_format != "auto") {
    throw CameraError(device.path + ": pixel_format, width and height of a recording cannot be chosen");
  }
  return std::make_unique<RecordingPlayer>(
      openRecording(device.path, device.format.rate, settings.images, settings.camera), clock, settings.loop,
      device.color);
}

}  // namespace

bool isDevice(const std::string& path) {
  return isNumber(path) || path.rfind("/dev/", 0) == 0 || std::filesystem::is_character_file(path);
}

std::unique_ptr<CameraSource> openCamera(const CameraSettings& settings, const std::shared_ptr<DeviceCalls>& calls,
                                         const std::shared_ptr<Clock>& clock) {
  if (!isDevice(settings.device.path)) return openPlayer(settings, clock);
  DeviceSettings device = settings.device;
  if (isNumber(device.path)) device.path = "/dev/video" + device.path;
  return std::make_unique<ReconnectingCamera>(
      [calls, clock, device] { return std::make_unique<DeviceCamera>(calls, clock, device); }, clock);
}

}  // namespace mba_vo
