#include "mba_vo/simulation/sensor.h"

#include <algorithm>
#include <cmath>

#include "mba_vo/geometry/angles.h"
#include "mba_vo/image/parallel_for.h"

namespace mba_vo {
namespace {

/// One step of SplitMix64: a hash with good bits everywhere.
std::uint64_t mix(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31);
}

/// Two independent standard normal numbers from a counter (Box-Muller).
cv::Vec2d normalPair(std::uint64_t stream, std::uint64_t counter) {
  const std::uint64_t bits = mix(stream ^ mix(counter));
  const double u = (static_cast<double>(bits >> 32) + 0.5) * 0x1p-32;
  const double v = static_cast<double>(bits & 0xFFFFFFFFULL) * 0x1p-32;
  const double radius = std::sqrt(-2.0 * std::log(u));
  return {radius * std::cos(kTwoPi * v), radius * std::sin(kTwoPi * v)};
}

double transmission(const cv::Mat1f& image, double vignette, int row, int col) {
  const double x = col - 0.5 * (image.cols - 1);
  const double y = row - 0.5 * (image.rows - 1);
  const double corner = 0.25 * ((image.cols - 1.0) * (image.cols - 1.0) + (image.rows - 1.0) * (image.rows - 1.0));
  return 1.0 - vignette * (x * x + y * y) / corner;
}

}  // namespace

cv::Mat1b expose(const cv::Mat1f& light, const SensorConfig& config, std::uint64_t stream) {
  cv::Mat1b image(light.size());
  const double inverse_gamma = 1.0 / config.gamma;
  parallelFor(static_cast<std::size_t>(light.rows), [&](std::size_t index) {
    const int row = static_cast<int>(index);
    cv::Vec2d normal;
    for (int col = 0; col < light.cols; ++col) {
      if (col % 2 == 0 && config.noise > 0.0) {
        normal = normalPair(stream, static_cast<std::uint64_t>(row) * 65536U + static_cast<std::uint64_t>(col));
      }
      double grey = config.brightness * static_cast<double>(light(row, col));
      if (config.vignette > 0.0) grey *= transmission(light, config.vignette, row, col);
      if (config.gamma != 1.0) grey = 255.0 * std::pow(grey / 255.0, inverse_gamma);
      grey = std::min(grey, 255.0) + config.noise * normal[col % 2];
      image(row, col) = cv::saturate_cast<std::uint8_t>(grey);
    }
  });
  return image;
}

}  // namespace mba_vo
