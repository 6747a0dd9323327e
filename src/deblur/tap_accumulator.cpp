#include "tap_accumulator.h"

#include <array>
#include <cmath>

namespace mba_vo {
namespace {

/// Cubic interpolation (Keys, a = -1/2). A linear one would blur a little across the path as well, and what comes out
/// would be sharpened too much.
std::array<float, 4> weightsAt(float f) {
  const float ff = f * f;
  const float fff = ff * f;
  return {-0.5F * f + ff - 0.5F * fff, 1.0F - 2.5F * ff + 1.5F * fff, 0.5F * f + 2.0F * ff - 1.5F * fff,
          0.5F * (fff - ff)};
}

}  // namespace

void TapAccumulator::begin(const Eigen::Vector2f& low, const Eigen::Vector2f& high) {
  x_ = static_cast<int>(std::floor(low.x())) - 1;
  y_ = static_cast<int>(std::floor(low.y())) - 1;
  width_ = static_cast<int>(std::floor(high.x())) + 3 - x_;
  height_ = static_cast<int>(std::floor(high.y())) + 3 - y_;
  weights_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0.0F);
}

void TapAccumulator::add(const Eigen::Vector2f& position, float weight) {
  const float x = std::floor(position.x());
  const float y = std::floor(position.y());
  const auto wx = weightsAt(position.x() - x);
  const auto wy = weightsAt(position.y() - y);
  float* row = weights_.data() + (static_cast<int>(y) - 1 - y_) * width_ + static_cast<int>(x) - 1 - x_;
  for (std::size_t j = 0; j < 4; ++j, row += width_) {
    for (std::size_t i = 0; i < 4; ++i) row[i] += weight * wx[i] * wy[j];
  }
}

}  // namespace mba_vo
