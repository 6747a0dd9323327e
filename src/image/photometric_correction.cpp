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

/// Linearises one pixel component. 16-bit values use the same curve, interpolated: 65535 / 257 = 255.
float linearise(const std::array<float, 256>& linear, std::uint8_t value) { return linear[value]; }
float linearise(const std::array<float, 256>& linear, std::uint16_t value) {
  const int low = value / 257;
  if (low == 255) return linear[255];
  const float weight = static_cast<float>(value - 257 * low) * (1.0F / 257.0F);
  const auto i = static_cast<std::size_t>(low);
  return linear[i] + weight * (linear[i + 1] - linear[i]);
}

template <typename Component>
void lineariseRow(const std::array<float, 256>& linear, const Component* in, int channels, int width, float* out) {
  if (channels == 1) {
    for (int x = 0; x < width; ++x) out[x] = linearise(linear, in[x]);
    return;
  }
  for (int x = 0; x < width; ++x, in += channels) {
    out[x] =
        kLuma[0] * linearise(linear, in[0]) + kLuma[1] * linearise(linear, in[1]) + kLuma[2] * linearise(linear, in[2]);
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

cv::Mat1f PhotometricCorrection::apply(const cv::Mat& image) const {
  requireSupported(image);
  cv::Mat1f result(image.size());
  for (int y = 0; y < image.rows; ++y) {
    if (image.depth() == CV_8U) {
      lineariseRow(linear_, image.ptr<std::uint8_t>(y), image.channels(), image.cols, result[y]);
    } else {
      lineariseRow(linear_, image.ptr<std::uint16_t>(y), image.channels(), image.cols, result[y]);
    }
    if (inverse_vignette_.empty()) continue;
    float* const out = result[y];
    const float* const inverse = inverse_vignette_[y];
    for (int x = 0; x < image.cols; ++x) out[x] *= inverse[x];
  }
  return result;
}

}  // namespace mba_vo
