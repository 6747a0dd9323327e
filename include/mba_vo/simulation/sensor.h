#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

namespace mba_vo {

struct SensorConfig {
  double gamma = 1.0;
  double noise = 1.0;       // standard deviation [grey levels]
  double vignette = 0.0;    // part of the light lost in the corners, growing with the square of the radius
  double brightness = 1.0;  // factor on the light
};

/// Turns light [grey levels, linear] into an 8-bit image. The same `stream` gives the same noise.
cv::Mat1b expose(const cv::Mat1f& light, const SensorConfig& config, std::uint64_t stream);

}  // namespace mba_vo
