#include "mba_vo/image/photometric_correction.h"

#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>

namespace mba_vo {
namespace {

constexpr float kMinVignette = 0.02F;                          // below it, noise is amplified more than 50 times
constexpr std::array<float, 3> kLuma{0.114F, 0.587F, 0.299F};  // of B, G, R (ITU-R BT.601)

std::array<float, 256> invertResponse(const std::vector<double>& inverse_response) {
  if (inverse_response.size() != 256) {
    throw std::invalid_argument("photometric response: " + std::to_string(inverse_response.size()) +
                                " values, must be 256");
  }
  const double black = inverse_response.front();
  const double scale = 255.0 / (inverse_response.back() - black);
  std::array<float, 256> linear{};
  for (std::size_t i = 0; i < 256; ++i) {
    if (!std::isfinite(inverse_response[i]) || (i > 0 && !(inverse_response[i] > inverse_response[i - 1]))) {
      throw std::invalid_argument("photometric response: value " + std::to_string(inverse_response[i]) +
                                  " of grey level " + std::to_string(i) +
                                  ", values must be finite and strictly increasing");
    }
    linear[i] = static_cast<float>(scale * (inverse_response[i] - black));
  }
  return linear;
}

std::array<float, 256> invertGamma(double gamma) {
  if (!(gamma > 0.0 && std::isfinite(gamma))) {
    throw std::invalid_argument("gamma is " + std::to_string(gamma) + ", must be greater than 0");
  }
  std::array<float, 256> linear{};
  for (std::size_t i = 0; i < 256; ++i) {
    const double level = static_cast<double>(i);
    linear[i] = static_cast<float>(gamma == 1.0 ? level : 255.0 * std::pow(level / 255.0, gamma));
  }
  return linear;
}

cv::Mat1f invertVignette(const cv::Mat1f& vignette, cv::Size size) {
  if (vignette.size() != size) {
    std::ostringstream message;
    message << "vignette is " << vignette.cols << "x" << vignette.rows << ", the camera calibration says " << size.width
            << "x" << size.height;
    throw std::invalid_argument(message.str());
  }
  cv::Mat1f inverse(size);
  auto out = inverse.begin();
  for (const float v : vignette) {
    if (!(v >= 0.0F && v <= 1.0F)) {
      throw std::invalid_argument("vignette: value " + std::to_string(v) + ", must be between 0 and 1");
    }
    *out++ = v < kMinVignette ? std::numeric_limits<float>::quiet_NaN() : 1.0F / v;
  }
  return inverse;
}

/// Linear grey levels of 8-bit components.
class EightBit {
 public:
  using Component = std::uint8_t;
  explicit EightBit(const std::array<float, 256>& linear) : linear_(linear) {}
  float operator()(Component value) const { return linear_[value]; }

 private:
  const std::array<float, 256>& linear_;
};

/// Of 16-bit components: the same curve, interpolated.
class SixteenBit {
 public:
  using Component = std::uint16_t;
  SixteenBit(const std::array<float, 256>& linear, double white_level)
      : linear_(linear), scale_(static_cast<float>(255.0 / white_level)) {}
  float operator()(Component value) const {
    const float level = scale_ * static_cast<float>(value);
    const auto i = static_cast<std::size_t>(level);
    if (i >= 255) return linear_[255];
    return linear_[i] + (level - static_cast<float>(i)) * (linear_[i + 1] - linear_[i]);
  }

 private:
  const std::array<float, 256>& linear_;
  float scale_;  // to grey levels
};

template <typename Lineariser>
void lineariseRow(const Lineariser& linear, const cv::Mat& image, int row, float* out) {
  const auto* in = image.ptr<typename Lineariser::Component>(row);
  const int channels = image.channels();
  if (channels == 1) {
    for (int x = 0; x < image.cols; ++x) out[x] = linear(in[x]);
    return;
  }
  for (int x = 0; x < image.cols; ++x, in += channels) {
    out[x] = kLuma[0] * linear(in[0]) + kLuma[1] * linear(in[1]) + kLuma[2] * linear(in[2]);
  }
}

void requireSupported(const cv::Mat& image) {
  const bool depth_known = image.depth() == CV_8U || image.depth() == CV_16U;
  const bool channels_known = image.channels() == 1 || image.channels() == 3 || image.channels() == 4;
  if (depth_known && channels_known) return;
  throw std::invalid_argument("image has type " + cv::typeToString(image.type()) +
                              ", must be 8- or 16-bit unsigned with 1, 3 (BGR) or 4 (BGRA) channels");
}

}  // namespace

PhotometricCorrection::PhotometricCorrection(const PhotometricCalibration& calibration, double gamma, cv::Size size)
    : linear_(calibration.inverse_response.empty() ? invertGamma(gamma)
                                                   : invertResponse(calibration.inverse_response)) {
  if (!calibration.vignette.empty()) inverse_vignette_ = invertVignette(calibration.vignette, size);
}

cv::Mat1f PhotometricCorrection::apply(const cv::Mat& image, double white_level) const {
  requireSupported(image);
  const EightBit eight_bit(linear_);
  const SixteenBit sixteen_bit(linear_, white_level);
  cv::Mat1f result(image.size());
  for (int y = 0; y < image.rows; ++y) {
    if (image.depth() == CV_8U) {
      lineariseRow(eight_bit, image, y, result[y]);
    } else {
      lineariseRow(sixteen_bit, image, y, result[y]);
    }
    if (inverse_vignette_.empty()) continue;
    float* const out = result[y];
    const float* const inverse = inverse_vignette_[y];
    for (int x = 0; x < image.cols; ++x) out[x] *= inverse[x];
  }
  return result;
}

}  // namespace mba_vo
