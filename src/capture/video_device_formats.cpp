// What a Video4Linux device offers.
#include <algorithm>
#include <sstream>

#include "mba_vo/capture/camera_source.h"
#include "mba_vo/capture/video_device.h"

namespace mba_vo {
namespace {

constexpr int kAskedWidth = 640, kAskedHeight = 480;  // where rates are asked for if there are many sizes [px]
constexpr int kAnySize = 1 << 14;                     // bound of the sizes of drivers that tell none [px]

double rateOf(const v4l2_fract& interval) {
  return interval.numerator > 0 ? static_cast<double>(interval.denominator) / interval.numerator : 0.0;
}

SizeRange singleSize(const v4l2_frmsize_discrete& size) {
  const int width = static_cast<int>(size.width), height = static_cast<int>(size.height);
  return {width, width, 1, height, height, 1};
}

SizeRange sizesInSteps(const v4l2_frmsize_stepwise& sizes) {
  return {static_cast<int>(sizes.min_width),  static_cast<int>(sizes.max_width),  static_cast<int>(sizes.step_width),
          static_cast<int>(sizes.min_height), static_cast<int>(sizes.max_height), static_cast<int>(sizes.step_height)};
}

}  // namespace

std::vector<OfferedFormat> VideoDevice::formats() const {
  std::vector<OfferedFormat> formats;
  v4l2_fmtdesc format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  for (; ioctl(VIDIOC_ENUM_FMT, &format) >= 0; ++format.index) {
    addSizes(format.pixelformat, formats);
  }
  return formats;
}

void VideoDevice::addSizes(std::uint32_t fourcc, std::vector<OfferedFormat>& formats) const {
  v4l2_frmsizeenum query{};
  query.pixel_format = fourcc;
  for (; ioctl(VIDIOC_ENUM_FRAMESIZES, &query) >= 0; ++query.index) {
    const bool single = query.type == V4L2_FRMSIZE_TYPE_DISCRETE;
    const SizeRange size = single ? singleSize(query.discrete) : sizesInSteps(query.stepwise);
    const int width = std::clamp(kAskedWidth, size.min_width, size.max_width);
    const int height = std::clamp(kAskedHeight, size.min_height, size.max_height);
    formats.push_back({fourcc, size, rates(fourcc, width, height)});
    if (!single) return;  // there is but one range
  }
  if (query.index == 0) formats.push_back({fourcc, {1, kAnySize, 1, 1, kAnySize, 1}, {}});
}

std::vector<RateRange> VideoDevice::rates(std::uint32_t fourcc, int width, int height) const {
  std::vector<RateRange> rates;
  v4l2_frmivalenum query{};
  query.pixel_format = fourcc;
  query.width = static_cast<std::uint32_t>(width);
  query.height = static_cast<std::uint32_t>(height);
  for (; ioctl(VIDIOC_ENUM_FRAMEINTERVALS, &query) >= 0; ++query.index) {
    if (query.type == V4L2_FRMIVAL_TYPE_DISCRETE) {
      rates.push_back({rateOf(query.discrete), rateOf(query.discrete)});
    } else {
      rates.push_back(
          {rateOf(query.stepwise.max), rateOf(query.stepwise.min)});  // the longest interval is the least rate
      break;
    }
  }
  return rates;
}

std::string listDevices(const std::shared_ptr<DeviceCalls>& calls) {
  std::ostringstream text;
  for (const std::string& path : calls->devices()) {
    try {
      const VideoDevice device(calls, path);
      text << path << " (" << device.name() << ")\n" << describe(device.formats());
    } catch (const CameraError& error) {
      text << error.what() << "\n";
    }
  }
  return text.tellp() > 0 ? text.str() : "there is no video device (/dev/video*)\n";
}

}  // namespace mba_vo
