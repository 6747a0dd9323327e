#pragma once

#include <deque>
#include <memory>
#include <string>

#include "mba_vo/capture/buffer_stamp.h"
#include "mba_vo/capture/camera_source.h"
#include "mba_vo/capture/exposure_control.h"
#include "mba_vo/capture/video_device.h"

namespace mba_vo {

struct DeviceSettings {
  std::string path;  // /dev/video0, /dev/v4l/by-id/...
  FormatRequest format;
  ExposureRequest exposure;
  bool color = false;     // BGR, else grey
  double read_out = 0.0;  // from the first row to the last [s]; 0 = global shutter
};

/// A Video4Linux camera. Its first events say what was set. Images that came damaged are told and counted in the
/// numbers; silence for some seconds counts as loss.
class DeviceCamera : public CameraSource {
 public:
  /// Opens and starts. Throws CameraError.
  DeviceCamera(std::shared_ptr<DeviceCalls> calls, std::shared_ptr<Clock> clock, const DeviceSettings& settings);
  CameraEvent next(std::int64_t timeout_ns) override;

 private:
  CaptureFormat choose() const;
  void warn();
  void announce(const BufferStamp& stamp);
  CameraEvent take(const VideoDevice::Buffer& buffer);
  CameraEvent tellDamaged(const std::string& problem);

  std::shared_ptr<Clock> clock_;
  DeviceSettings settings_;
  VideoDevice device_;
  CaptureFormat format_;
  ExposureControl exposure_;
  std::deque<CameraNotice> notices_;
  bool announced_ = false;
  std::int64_t last_image_ns_;  // monotonic clock
  std::uint32_t last_sequence_ = 0;
  std::uint64_t number_ = 0;
  std::uint64_t damaged_ = 0;
  std::int64_t damage_told_ns_ = 0;  // monotonic clock; 0 = never
};

}  // namespace mba_vo
