#include "mba_vo/image/white_level.h"

#include <algorithm>
#include <array>

namespace mba_vo {
namespace {

constexpr double kEightBit = 255.0;
constexpr int kMostChannels = 3;                                              // what follows is no light
constexpr std::array<double, 4> kPossible{1023.0, 4095.0, 16383.0, 65535.0};  // 10, 12, 14 and 16 bits

}  // namespace

double WhiteLevel::of(const cv::Mat& image) {
  if (image.depth() != CV_16U) return kEightBit;
  if (told_ > 0.0) return told_;
  for (int channel = 0; channel < std::min(image.channels(), kMostChannels); ++channel) {
    cv::Mat values;
    cv::extractChannel(image, values, channel);
    double largest = 0.0;
    cv::minMaxLoc(values, nullptr, &largest);
    found_ = std::max(found_, *std::lower_bound(kPossible.begin(), kPossible.end(), largest));
  }
  return found_;
}

}  // namespace mba_vo
