#include "mba_vo/ros/image_conversion.h"

#include <stdexcept>

#include <sensor_msgs/image_encodings.h>

namespace mba_vo {
namespace {

namespace enc = sensor_msgs::image_encodings;

/// What to ask cv_bridge for; empty: as it is.
std::string wantedEncoding(const std::string& encoding) {
  if (encoding == enc::MONO8 || encoding == enc::MONO16 || encoding == enc::BGR8 || encoding == enc::BGRA8 ||
      encoding == enc::BGR16 || encoding == enc::BGRA16 || encoding == "8UC1" || encoding == "16UC1" ||
      encoding == "8UC3" || encoding == "8UC4" || encoding == "16UC3" || encoding == "16UC4") {
    return "";
  }
  if (encoding == enc::RGB8 || encoding == enc::RGBA8 || encoding == enc::YUV422) {
    return enc::MONO8;
  }
  if (encoding == enc::RGB16 || encoding == enc::RGBA16) {
    return enc::MONO16;
  }
  if (enc::isBayer(encoding)) {
    return enc::bitDepth(encoding) == 16 ? enc::MONO16 : enc::MONO8;
  }
  throw std::invalid_argument("image encoding is '" + encoding +
                              "'; allowed: 8- or 16-bit mono, bgr, rgb (with or without alpha), bayer, yuv422");
}

}  // namespace

cv_bridge::CvImageConstPtr toCvImage(const sensor_msgs::ImageConstPtr& message) {
  const std::string wanted = wantedEncoding(message->encoding);
  try {
    return cv_bridge::toCvShare(message, wanted);
  } catch (const cv::Exception& error) {
    throw std::invalid_argument("image of encoding '" + message->encoding + "' cannot be read: " + error.what());
  } catch (const cv_bridge::Exception& error) {
    throw std::invalid_argument("image of encoding '" + message->encoding + "' cannot be read: " + error.what());
  }
}

std::string encodingOf(const cv::Mat& image) {
  switch (image.type()) {
    case CV_8UC1:
      return enc::MONO8;
    case CV_16UC1:
      return enc::MONO16;
    case CV_8UC3:
      return enc::BGR8;
    case CV_8UC4:
      return enc::BGRA8;
    case CV_16UC3:
      return enc::BGR16;
    case CV_32FC1:
      return enc::TYPE_32FC1;
    default:
      throw std::invalid_argument("OpenCV image type " + cv::typeToString(image.type()) +
                                  " cannot be written; allowed: 8UC1, 16UC1, 8UC3, 8UC4, 16UC3, 32FC1");
  }
}

}  // namespace mba_vo
