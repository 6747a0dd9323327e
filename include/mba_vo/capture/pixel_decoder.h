#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "mba_vo/capture/capture_format.h"
#include "mba_vo/capture/video_device.h"

namespace mba_vo {

struct DecodedImage {
  cv::Mat image;        // 8 bit, grey or BGR; empty if there is a problem
  std::string problem;  // what is wrong with the bytes
};

/// The image in a buffer of the driver (grey, YUYV or JPEG), whose memory it does not share. Half an image is none.
DecodedImage decodeBuffer(const VideoDevice::Buffer& buffer, const CaptureFormat& format, bool color);

}  // namespace mba_vo
