#include "mba_vo/image/saturation.h"

#include <algorithm>

namespace mba_vo {
namespace {

constexpr double kWhite = 254.0 / 255.0;  // of the white level: noise and compression take a little away
constexpr int kColours = 3;               // what follows is no light

}  // namespace

cv::Mat1b saturatedPixels(const cv::Mat& image, double white_level) {
  const double white = kWhite * (image.depth() == CV_8U ? 255.0 : white_level);
  cv::Mat1b saturated(image.size(), std::uint8_t{0});
  for (int channel = 0; channel < std::min(image.channels(), kColours); ++channel) {
    cv::Mat values, of_channel;
    cv::extractChannel(image, values, channel);
    cv::compare(values, white, of_channel, cv::CMP_GE);
    saturated |= of_channel;
  }
  return saturated;
}

}  // namespace mba_vo
