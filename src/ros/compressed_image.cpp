#include "mba_vo/ros/compressed_image.h"

#include <stdexcept>
#include <string>

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/image_encodings.h>
#include <opencv2/imgcodecs.hpp>

#include "mba_vo/ros/image_conversion.h"

namespace mba_vo {
namespace {

namespace enc = sensor_msgs::image_encodings;

cv::Mat decodeData(const sensor_msgs::CompressedImage& message) {
  cv::Mat image;
  std::string why;
  try {
    if (!message.data.empty()) image = cv::imdecode(message.data, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception& error) {
    why = std::string(": ") + error.what();
  }
  if (!image.empty()) return image;
  throw std::invalid_argument("compressed image of format '" + message.format + "' and " +
                              std::to_string(message.data.size()) + " bytes cannot be decoded; allowed: jpeg, png" +
                              why);
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Files hold colours as blue, green, red once decoded, unless the sender compressed them in the order that they had:
/// then the format names no "bgr". Mosaics are stored as grey images.
std::string encodingOfDecoded(const cv::Mat& image, const std::string& format) {
  const std::size_t end = format.find(';');
  const std::string original = end == std::string::npos ? "" : format.substr(0, end);
  const bool deep = image.depth() == CV_16U;
  if (image.channels() == 1 && enc::isBayer(original) && enc::bitDepth(original) == (deep ? 16 : 8)) return original;
  if (contains(original, "rgb") && image.channels() > 1 && !contains(format.substr(end), "bgr")) {
    if (image.channels() == 4) return deep ? enc::RGBA16 : enc::RGBA8;
    return deep ? enc::RGB16 : enc::RGB8;
  }
  return encodingOf(image);
}

}  // namespace

sensor_msgs::ImageConstPtr decodeImage(const sensor_msgs::CompressedImage& message) {
  const cv::Mat image = decodeData(message);
  return cv_bridge::CvImage(message.header, encodingOfDecoded(image, message.format), image).toImageMsg();
}

}  // namespace mba_vo
