#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <linux/videodev2.h>

#include "mba_vo/capture/capture_format.h"
#include "mba_vo/capture/device_calls.h"

namespace mba_vo {

/// An open Video4Linux capture device. Everything throws CameraError naming the device and what is wrong, and
/// CameraLost once it has gone.
class VideoDevice {
 public:
  VideoDevice(std::shared_ptr<DeviceCalls> calls, const std::string& path);
  ~VideoDevice();
  VideoDevice(const VideoDevice&) = delete;
  VideoDevice& operator=(const VideoDevice&) = delete;

  const std::string& path() const { return path_; }
  const std::string& name() const { return name_; }  // as its maker calls it

  /// Every format with every size and its rates; of sizes in steps the rates next to 640x480.
  std::vector<OfferedFormat> formats() const;

  /// Sets format and rate; the rate of the result is the one that the device really took, 0 if it does not tell.
  CaptureFormat configure(const CaptureFormat& format);
  void start();

  /// Valid until the function that it is handed to returns.
  struct Buffer {
    const unsigned char* data;
    std::size_t size;  // [bytes]
    int bytes_per_row;
    const v4l2_buffer& info;
  };
  /// Hands over the oldest image that is waiting; false if there was none within the time [ms].
  bool next(int milliseconds, const std::function<void(const Buffer&)>& use);

  /// A control (V4L2_CID_...) that can be used; nullopt if the device has none.
  std::optional<v4l2_queryctrl> control(std::uint32_t id) const;
  bool hasMenuItem(std::uint32_t id, std::uint32_t item) const;
  std::optional<int> value(std::uint32_t id) const;
  /// False if the device refuses.
  bool setValue(std::uint32_t id, int value);

 private:
  struct Memory {
    void* data;
    std::size_t length;
  };

  int ioctl(unsigned long request, void* argument) const;
  void require(int result, const std::string& what) const;
  void checkCapabilities();
  void addSizes(std::uint32_t fourcc, std::vector<OfferedFormat>& formats) const;
  std::vector<RateRange> rates(std::uint32_t fourcc, int width, int height) const;
  double setRate(double rate);
  void mapBuffers();
  void close();

  std::shared_ptr<DeviceCalls> calls_;
  std::string path_;
  std::string name_;
  int descriptor_ = -1;
  int bytes_per_row_ = 0;
  bool streaming_ = false;
  std::vector<Memory> buffers_;
};

/// All capture devices with their names and formats, for the user.
std::string listDevices(const std::shared_ptr<DeviceCalls>& calls);

}  // namespace mba_vo
