#pragma once

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <linux/videodev2.h>

#include "capture/fake_clock.h"
#include "mba_vo/capture/device_calls.h"

namespace mba_vo {

/// A webcam that speaks Video4Linux as uvcvideo does, and misbehaves where a test says so.
class FakeDevice : public DeviceCalls {
 public:
  struct Size {
    std::uint32_t width, height;
    std::vector<std::uint32_t> rates;  // [Hz]
  };
  struct Control {
    int minimum, maximum, step, value;
    std::vector<std::uint32_t> menu{};
    bool stuck = false;  // takes values, and goes on saying the old one
  };
  struct Image {
    std::vector<unsigned char> bytes;
    std::int64_t stamp_ns = 0;  // monotonic clock
    std::uint32_t sequence = 0;
    std::uint32_t flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  };

  explicit FakeDevice(std::shared_ptr<FakeClock> clock);

  // What it can do; to be changed before it is opened.
  std::vector<std::string> paths{"/dev/video0", "/dev/video1"};  // the second is there, and gives no images
  std::map<std::uint32_t, std::vector<Size>> formats;
  bool sizes_in_steps = false;  // from the first size to the last, in steps of 8
  std::map<std::uint32_t, Control> controls;
  int open_error = 0, busy_error = 0;              // errno
  std::uint32_t takes_height = 0, takes_rate = 0;  // whatever it is asked for; 0 = what it is asked for
  // What it has been told.
  v4l2_pix_format format{};
  std::uint32_t rate = 30;
  bool streaming = false;
  int opened = 0;  // descriptors now

  void send(Image image) { images_.push_back(std::move(image)); }
  /// A grey image of the size that was set, taken now.
  void sendGrey(unsigned char level, std::uint32_t sequence);
  void unplug();
  void plugIn() { plugged_ = true; }

  std::vector<std::string> devices() const override;
  int open(const std::string& path) override;
  void close(int descriptor) override;
  int ioctl(int descriptor, unsigned long request, void* argument) override;
  void* map(int descriptor, std::size_t length, std::size_t offset) override;
  void unmap(void* memory, std::size_t length) override;
  int wait(int descriptor, int milliseconds) override;

 private:
  static constexpr int kImages = 3, kMetadata = 4;  // descriptors

  int capabilities(v4l2_capability& capability, bool gives_images) const;
  int formatAt(v4l2_fmtdesc& query) const;
  int size(v4l2_frmsizeenum& query) const;
  int interval(v4l2_frmivalenum& query) const;
  int setFormat(v4l2_format& wanted);
  int parameters(v4l2_streamparm& parameters, bool set);
  int buffers(unsigned long request, void* argument);
  int take(v4l2_buffer& buffer);
  int controlCall(unsigned long request, void* argument);

  std::shared_ptr<FakeClock> clock_;
  bool plugged_ = true;
  std::deque<Image> images_;
  std::vector<std::vector<unsigned char>> memory_;
  std::deque<std::uint32_t> free_buffers_;
};

inline FakeDevice::FakeDevice(std::shared_ptr<FakeClock> clock) : clock_(std::move(clock)) {
  formats[V4L2_PIX_FMT_YUYV] = {{640, 480, {30, 15}}, {1280, 720, {10}}};
  formats[V4L2_PIX_FMT_MJPEG] = {{640, 480, {30}}, {1280, 720, {30}}};
  controls[V4L2_CID_EXPOSURE_AUTO] = {0, 3, 1, 3, {V4L2_EXPOSURE_MANUAL, V4L2_EXPOSURE_APERTURE_PRIORITY}};
  controls[V4L2_CID_EXPOSURE_ABSOLUTE] = {3, 2047, 1, 250};
  controls[V4L2_CID_EXPOSURE_AUTO_PRIORITY] = {0, 1, 1, 1};
}

inline std::vector<std::string> FakeDevice::devices() const { return plugged_ ? paths : std::vector<std::string>(); }

inline void FakeDevice::sendGrey(unsigned char level, std::uint32_t sequence) {
  send({std::vector<unsigned char>(format.sizeimage, level), clock_->monotonicNow(), sequence});
}

inline void FakeDevice::unplug() {
  plugged_ = false;
  streaming = false;
  images_.clear();
}

inline int FakeDevice::open(const std::string& path) {
  if (!plugged_ || std::find(paths.begin(), paths.end(), path) == paths.end()) return -ENOENT;
  if (open_error != 0) return -open_error;
  ++opened;
  return path == paths.front() ? kImages : kMetadata;
}

inline void FakeDevice::close(int /*descriptor*/) {
  --opened;
  streaming = false;
}

inline void* FakeDevice::map(int /*descriptor*/, std::size_t /*length*/, std::size_t offset) {
  return offset < memory_.size() ? memory_[offset].data() : nullptr;
}

inline void FakeDevice::unmap(void* /*memory*/, std::size_t /*length*/) {}

inline int FakeDevice::wait(int /*descriptor*/, int milliseconds) {
  if (!plugged_ || (streaming && !images_.empty())) return 1;
  clock_->sleepFor(std::int64_t{1'000'000} * milliseconds);
  return 0;
}

inline int FakeDevice::ioctl(int descriptor, unsigned long request, void* argument) {
  if (!plugged_) return -ENODEV;
  switch (request) {
    case VIDIOC_QUERYCAP:
      return capabilities(*static_cast<v4l2_capability*>(argument), descriptor == kImages);
    case VIDIOC_ENUM_FMT:
      return formatAt(*static_cast<v4l2_fmtdesc*>(argument));
    case VIDIOC_ENUM_FRAMESIZES:
      return size(*static_cast<v4l2_frmsizeenum*>(argument));
    case VIDIOC_ENUM_FRAMEINTERVALS:
      return interval(*static_cast<v4l2_frmivalenum*>(argument));
    case VIDIOC_S_FMT:
      return setFormat(*static_cast<v4l2_format*>(argument));
    case VIDIOC_G_PARM:
    case VIDIOC_S_PARM:
      return parameters(*static_cast<v4l2_streamparm*>(argument), request == VIDIOC_S_PARM);
    case VIDIOC_STREAMON:
    case VIDIOC_STREAMOFF:
      if (request == VIDIOC_STREAMON && busy_error != 0) return -busy_error;
      streaming = request == VIDIOC_STREAMON;
      return 0;
    case VIDIOC_REQBUFS:
    case VIDIOC_QUERYBUF:
    case VIDIOC_QBUF:
    case VIDIOC_DQBUF:
      return buffers(request, argument);
    default:
      return controlCall(request, argument);
  }
}

inline int FakeDevice::capabilities(v4l2_capability& capability, bool gives_images) const {
  std::strcpy(reinterpret_cast<char*>(capability.card), "Fake Webcam");
  capability.capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING | V4L2_CAP_DEVICE_CAPS;
  capability.device_caps = V4L2_CAP_STREAMING | (gives_images ? V4L2_CAP_VIDEO_CAPTURE : V4L2_CAP_META_CAPTURE);
  return 0;
}

inline int FakeDevice::formatAt(v4l2_fmtdesc& query) const {
  if (query.index >= formats.size()) return -EINVAL;
  query.pixelformat = std::next(formats.begin(), query.index)->first;
  return 0;
}

inline int FakeDevice::size(v4l2_frmsizeenum& query) const {
  const std::vector<Size>& sizes = formats.at(query.pixel_format);
  if (query.index >= (sizes_in_steps ? 1 : sizes.size())) return -EINVAL;
  if (sizes_in_steps) {
    query.type = V4L2_FRMSIZE_TYPE_STEPWISE;
    query.stepwise = {sizes.front().width, sizes.back().width, 8, sizes.front().height, sizes.back().height, 8};
  } else {
    query.type = V4L2_FRMSIZE_TYPE_DISCRETE;
    query.discrete = {sizes[query.index].width, sizes[query.index].height};
  }
  return 0;
}

inline int FakeDevice::interval(v4l2_frmivalenum& query) const {
  if (sizes_in_steps) {
    if (query.index > 0) return -EINVAL;
    query.type = V4L2_FRMIVAL_TYPE_CONTINUOUS;
    query.stepwise = {{1, 60}, {1, 5}, {1, 1}};
    return 0;
  }
  for (const Size& size : formats.at(query.pixel_format)) {
    if (size.width != query.width || size.height != query.height || query.index >= size.rates.size()) continue;
    query.type = V4L2_FRMIVAL_TYPE_DISCRETE;
    query.discrete = {1, size.rates[query.index]};
    return 0;
  }
  return -EINVAL;
}

inline int FakeDevice::setFormat(v4l2_format& wanted) {
  if (busy_error != 0) return -busy_error;
  v4l2_pix_format& pixels = wanted.fmt.pix;
  if (takes_height > 0) pixels.height = takes_height;
  const std::uint32_t bytes = pixels.pixelformat == V4L2_PIX_FMT_YUYV ? 2 : 1;
  pixels.bytesperline = pixels.pixelformat == V4L2_PIX_FMT_MJPEG ? 0 : bytes * pixels.width;
  pixels.sizeimage = bytes * pixels.width * pixels.height;
  format = pixels;
  return 0;
}

inline int FakeDevice::parameters(v4l2_streamparm& parameters, bool set) {
  v4l2_fract& interval = parameters.parm.capture.timeperframe;
  if (set) rate = takes_rate > 0 ? takes_rate : interval.denominator / interval.numerator;
  parameters.parm.capture.capability = V4L2_CAP_TIMEPERFRAME;
  interval = {1, rate};
  return 0;
}

inline int FakeDevice::buffers(unsigned long request, void* argument) {
  if (request == VIDIOC_REQBUFS) {
    memory_.assign(static_cast<v4l2_requestbuffers*>(argument)->count,
                   std::vector<unsigned char>(format.sizeimage + 1024));
    free_buffers_.clear();
    return 0;
  }
  v4l2_buffer& buffer = *static_cast<v4l2_buffer*>(argument);
  if (request == VIDIOC_DQBUF) return take(buffer);
  if (buffer.index >= memory_.size()) return -EINVAL;
  if (request == VIDIOC_QUERYBUF) {
    buffer.length = static_cast<std::uint32_t>(memory_[buffer.index].size());
    buffer.m.offset = buffer.index;
  } else {
    free_buffers_.push_back(buffer.index);
  }
  return 0;
}

inline int FakeDevice::take(v4l2_buffer& buffer) {
  if (images_.empty() || free_buffers_.empty()) return -EAGAIN;
  const Image image = images_.front();
  images_.pop_front();
  buffer.index = free_buffers_.front();
  free_buffers_.pop_front();
  buffer.bytesused = static_cast<std::uint32_t>(image.bytes.size());
  std::copy(image.bytes.begin(), image.bytes.end(), memory_[buffer.index].begin());
  buffer.flags = image.flags;
  buffer.sequence = image.sequence;
  buffer.timestamp = {image.stamp_ns / 1'000'000'000, image.stamp_ns / 1'000 % 1'000'000};
  return 0;
}

inline int FakeDevice::controlCall(unsigned long request, void* argument) {
  const std::uint32_t id = *static_cast<std::uint32_t*>(argument);  // all three begin with it
  const auto found = controls.find(id);
  if (found == controls.end()) return -EINVAL;
  Control& control = found->second;
  switch (request) {
    case VIDIOC_QUERYCTRL: {
      auto& query = *static_cast<v4l2_queryctrl*>(argument);
      query.minimum = control.minimum;
      query.maximum = control.maximum;
      query.step = control.step;
      return 0;
    }
    case VIDIOC_QUERYMENU: {
      const std::uint32_t item = static_cast<v4l2_querymenu*>(argument)->index;
      return std::count(control.menu.begin(), control.menu.end(), item) > 0 ? 0 : -EINVAL;
    }
    case VIDIOC_G_CTRL:
      static_cast<v4l2_control*>(argument)->value = control.value;
      return 0;
    case VIDIOC_S_CTRL:
      if (!control.stuck) control.value = static_cast<v4l2_control*>(argument)->value;
      return 0;
    default:
      return -ENOTTY;
  }
}

}  // namespace mba_vo
