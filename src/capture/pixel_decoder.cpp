#include "mba_vo/capture/pixel_decoder.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace mba_vo {
namespace {

DecodedImage faulty(const std::string& problem) { return {cv::Mat(), problem}; }

/// Cameras pad with zeros behind the end of the image, the marker FF D9. OpenCV would paint what is missing grey.
bool hasJpegEnd(const unsigned char* data, std::size_t size) {
  while (size > 0 && data[size - 1] == 0) --size;
  return size >= 2 && data[size - 2] == 0xff && data[size - 1] == 0xd9;
}

DecodedImage decodeJpeg(const VideoDevice::Buffer& buffer, const CaptureFormat& format, bool color) {
  if (!hasJpegEnd(buffer.data, buffer.size)) return faulty("the JPEG image is cut off");
  // OpenCV does not write to it.
  const cv::Mat bytes(1, static_cast<int>(buffer.size), CV_8UC1, const_cast<unsigned char*>(buffer.data));
  const cv::Mat image = cv::imdecode(bytes, color ? cv::IMREAD_COLOR : cv::IMREAD_GRAYSCALE);
  if (image.empty()) return faulty("the JPEG image cannot be read");
  if (image.cols != format.width || image.rows != format.height) {
    return faulty("the JPEG image is " + std::to_string(image.cols) + "x" + std::to_string(image.rows));
  }
  return {image, ""};
}

}  // namespace

DecodedImage decodeBuffer(const VideoDevice::Buffer& buffer, const CaptureFormat& format, bool color) {
  const bool grey = format.fourcc == V4L2_PIX_FMT_GREY;
  if (!grey && format.fourcc != V4L2_PIX_FMT_YUYV) return decodeJpeg(buffer, format, color);
  const std::size_t row = static_cast<std::size_t>(format.width) * (grey ? 1 : 2);
  const std::size_t stride = std::max(row, static_cast<std::size_t>(buffer.bytes_per_row));
  const std::size_t needed = stride * static_cast<std::size_t>(format.height - 1) + row;
  if (buffer.size < needed) {
    return faulty("the image has " + std::to_string(buffer.size) + " of " + std::to_string(needed) + " bytes");
  }
  const cv::Mat pixels(format.height, format.width, grey ? CV_8UC1 : CV_8UC2, const_cast<unsigned char*>(buffer.data),
                       stride);
  DecodedImage result;
  if (grey) {
    result.image = pixels.clone();
  } else {
    cv::cvtColor(pixels, result.image, color ? cv::COLOR_YUV2BGR_YUYV : cv::COLOR_YUV2GRAY_YUYV);
  }
  return result;
}

}  // namespace mba_vo
