#include "mba_vo/depth_search/nearby_depths.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace mba_vo {
namespace {

constexpr std::size_t kMinPoints = 20;
constexpr double kLeastSigma = 0.3;       // relative: between points there are steps (2026-11-29-within-reach.md)
constexpr std::size_t kUsedPoints = 400;  // more do not change a guess, but cost time

}  // namespace

NearbyDepths::NearbyDepths(const std::vector<ReferencePoint>& points) : known_(points.size() >= kMinPoints) {
  const std::size_t stride = std::max<std::size_t>(points.size() / kUsedPoints, 1);
  sample_.reserve(points.size() / stride + 1);
  for (std::size_t i = 0; i < points.size(); i += stride) sample_.push_back(points[i]);
}

DepthGuess NearbyDepths::at(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2f place = pixel.cast<float>();
  float sum = 0.0F;
  float squares = 0.0F;
  float weights = 0.0F;
  for (const ReferencePoint& point : sample_) {
    const float squared_distance = (point.pixel - place).squaredNorm();
    const float weight = 1.0F / (squared_distance * squared_distance + 1.0F);
    sum += weight * point.inverse_depth;
    squares += weight * point.inverse_depth * point.inverse_depth;
    weights += weight;
  }
  const auto mean = static_cast<double>(sum / weights);
  const double variance = std::max(0.0, static_cast<double>(squares / weights) - mean * mean);
  return {mean, std::max(std::sqrt(variance), kLeastSigma * mean)};
}

}  // namespace mba_vo
