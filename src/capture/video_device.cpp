#include "mba_vo/capture/video_device.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <sstream>
#include <system_error>

#include "mba_vo/capture/camera_source.h"

namespace mba_vo {
namespace {

constexpr std::uint32_t kBuffers = 4;  // one being read, one being filled, two that bridge a busy moment
constexpr std::uint32_t kCapture = V4L2_BUF_TYPE_VIDEO_CAPTURE;

std::string textOf(int error) { return std::generic_category().message(error); }

/// Cameras that could be meant instead.
std::string others(DeviceCalls& calls) {
  const std::vector<std::string> paths = calls.devices();
  if (paths.empty()) return "there is no video device at all";
  std::string text = "there are:";
  for (const std::string& path : paths) text += " " + path;
  return text;
}

[[noreturn]] void failToOpen(DeviceCalls& calls, const std::string& path, int error) {
  switch (error) {
    case EACCES:
    case EPERM:
      throw CameraError(
          path + ": no permission; your user must be in its group: sudo usermod -aG video $USER, then log in again");
    case ENOENT:
    case ENODEV:
    case ENXIO:
      throw CameraError(path + ": no such device; " + others(calls));
    case EBUSY:
      throw CameraError(path + ": another program uses it");
    default:
      throw CameraError(path + ": cannot be opened: " + textOf(error));
  }
}

}  // namespace

VideoDevice::VideoDevice(std::shared_ptr<DeviceCalls> calls, const std::string& path)
    : calls_(std::move(calls)), path_(path) {
  descriptor_ = calls_->open(path_);
  if (descriptor_ < 0) failToOpen(*calls_, path_, -descriptor_);
  try {
    checkCapabilities();
  } catch (...) {
    close();
    throw;
  }
}

VideoDevice::~VideoDevice() { close(); }

void VideoDevice::close() {
  if (streaming_) {
    std::uint32_t type = kCapture;
    ioctl(VIDIOC_STREAMOFF, &type);
  }
  for (const Memory& buffer : buffers_) calls_->unmap(buffer.data, buffer.length);
  buffers_.clear();
  if (descriptor_ >= 0) calls_->close(descriptor_);
  descriptor_ = -1;
}

int VideoDevice::ioctl(unsigned long request, void* argument) const {
  return calls_->ioctl(descriptor_, request, argument);
}

void VideoDevice::require(int result, const std::string& what) const {
  if (result >= 0) return;
  switch (-result) {
    case ENODEV:
    case ENXIO:
      throw CameraLost(path_ + ": it was unplugged");
    case EBUSY:
      throw CameraError(path_ + ": another program uses it (" + what + ")");
    case ENOSPC:
      throw CameraError(path_ +
                        ": the USB bus has too little bandwidth left for this format; use mjpeg, a smaller size or "
                        "rate, or another socket");
    default:
      throw CameraError(path_ + ": " + what + ": " + textOf(-result));
  }
}

void VideoDevice::checkCapabilities() {
  v4l2_capability capability{};
  const int result = ioctl(VIDIOC_QUERYCAP, &capability);
  if (result == -ENOTTY || result == -EINVAL)
    throw CameraError(path_ + ": this is no video device; " + others(*calls_));
  require(result, "it does not say what it can do");
  name_ = reinterpret_cast<const char*>(capability.card);
  const std::uint32_t can =
      (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? capability.device_caps : capability.capabilities;
  if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0) {
    // Webcams have a second device for metadata.
    throw CameraError(path_ + " (" + name_ + "): this device gives no images; " + others(*calls_));
  }
  if ((can & V4L2_CAP_STREAMING) == 0) throw CameraError(path_ + " (" + name_ + "): it cannot stream");
}

CaptureFormat VideoDevice::configure(const CaptureFormat& format) {
  v4l2_format wanted{};
  wanted.type = kCapture;
  wanted.fmt.pix.width = static_cast<std::uint32_t>(format.width);
  wanted.fmt.pix.height = static_cast<std::uint32_t>(format.height);
  wanted.fmt.pix.pixelformat = format.fourcc;
  wanted.fmt.pix.field = V4L2_FIELD_NONE;
  require(ioctl(VIDIOC_S_FMT, &wanted), describe(format) + " cannot be set");
  CaptureFormat set = format;
  set.fourcc = wanted.fmt.pix.pixelformat;
  set.width = static_cast<int>(wanted.fmt.pix.width);
  set.height = static_cast<int>(wanted.fmt.pix.height);
  if (set.fourcc != format.fourcc || set.width != format.width || set.height != format.height) {
    set.rate = 0.0;
    throw CameraError(path_ + " (" + name_ + "): asked for " + describe(format) + " it takes " + describe(set));
  }
  bytes_per_row_ = static_cast<int>(wanted.fmt.pix.bytesperline);
  set.rate = setRate(format.rate);
  return set;
}

double VideoDevice::setRate(double rate) {
  v4l2_streamparm parameters{};
  parameters.type = kCapture;
  const v4l2_fract& interval = parameters.parm.capture.timeperframe;
  if (ioctl(VIDIOC_G_PARM, &parameters) < 0) return 0.0;
  if (rate > 0.0 && (parameters.parm.capture.capability & V4L2_CAP_TIMEPERFRAME) != 0) {
    constexpr std::uint32_t kMillisecondsPerSecond = 1000;  // 29.97 Hz is 1000 / 29970
    parameters.parm.capture.timeperframe.numerator = kMillisecondsPerSecond;
    parameters.parm.capture.timeperframe.denominator =
        static_cast<std::uint32_t>(std::lround(rate * kMillisecondsPerSecond));
    require(ioctl(VIDIOC_S_PARM, &parameters), "the rate cannot be set");
  }
  return interval.numerator > 0 ? static_cast<double>(interval.denominator) / interval.numerator : 0.0;
}

void VideoDevice::start() {
  mapBuffers();
  std::uint32_t type = kCapture;
  require(ioctl(VIDIOC_STREAMON, &type), "it does not start");
  streaming_ = true;
}

void VideoDevice::mapBuffers() {
  v4l2_requestbuffers request{};
  request.count = kBuffers;
  request.type = kCapture;
  request.memory = V4L2_MEMORY_MMAP;
  require(ioctl(VIDIOC_REQBUFS, &request), "it gives no buffers");
  for (std::uint32_t i = 0; i < request.count; ++i) {
    v4l2_buffer buffer{};
    buffer.type = kCapture;
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.index = i;
    require(ioctl(VIDIOC_QUERYBUF, &buffer), "it gives no buffers");
    void* memory = calls_->map(descriptor_, buffer.length, buffer.m.offset);
    if (memory == nullptr) throw CameraError(path_ + ": its buffers cannot be mapped");
    buffers_.push_back({memory, buffer.length});
    require(ioctl(VIDIOC_QBUF, &buffer), "it takes no buffers");
  }
}

bool VideoDevice::next(int milliseconds, const std::function<void(const Buffer&)>& use) {
  const int waited = calls_->wait(descriptor_, milliseconds);
  require(waited, "waiting for an image");
  if (waited == 0) return false;
  v4l2_buffer info{};
  info.type = kCapture;
  info.memory = V4L2_MEMORY_MMAP;
  const int result = ioctl(VIDIOC_DQBUF, &info);
  if (result == -EAGAIN) return false;
  if (result == -EIO) throw CameraLost(path_ + ": it gives errors in place of images");
  require(result, "an image cannot be taken");
  const Memory& memory = buffers_.at(info.index);
  use({static_cast<const unsigned char*>(memory.data), std::min<std::size_t>(info.bytesused, memory.length),
       bytes_per_row_, info});
  require(ioctl(VIDIOC_QBUF, &info), "it does not take its buffer back");
  return true;
}

std::optional<v4l2_queryctrl> VideoDevice::control(std::uint32_t id) const {
  v4l2_queryctrl query{};
  query.id = id;
  if (ioctl(VIDIOC_QUERYCTRL, &query) < 0 || (query.flags & V4L2_CTRL_FLAG_DISABLED) != 0) return std::nullopt;
  return query;
}

bool VideoDevice::hasMenuItem(std::uint32_t id, std::uint32_t item) const {
  v4l2_querymenu query{};
  query.id = id;
  query.index = item;
  return ioctl(VIDIOC_QUERYMENU, &query) >= 0;
}

std::optional<int> VideoDevice::value(std::uint32_t id) const {
  v4l2_control control{id, 0};
  if (ioctl(VIDIOC_G_CTRL, &control) < 0) return std::nullopt;
  return control.value;
}

bool VideoDevice::setValue(std::uint32_t id, int value) {
  v4l2_control control{id, value};
  return ioctl(VIDIOC_S_CTRL, &control) >= 0;
}

}  // namespace mba_vo
