#include "mba_vo/image/spacing_grid.h"

#include <algorithm>
#include <cmath>

namespace mba_vo {
namespace {

constexpr double kMinDistance = 2.0;   // [px]
constexpr double kMaxDistance = 30.0;  // [px]

}  // namespace

SpacingGrid::SpacingGrid(const PinholeCamera& camera, double distance_px)
    : distance_px_(distance_px),
      columns_(static_cast<int>(std::ceil(camera.width / distance_px)) + 1),
      rows_(static_cast<int>(std::ceil(camera.height / distance_px)) + 1),
      occupied_(static_cast<std::size_t>(columns_ * rows_), false) {}

std::size_t SpacingGrid::cell(const Eigen::Vector2d& pixel) const {
  const int column = std::clamp(static_cast<int>(pixel.x() / distance_px_), 0, columns_ - 1);
  const int row = std::clamp(static_cast<int>(pixel.y() / distance_px_), 0, rows_ - 1);
  return static_cast<std::size_t>(row * columns_ + column);
}

double adaptedDistance(double distance_px, int points, int wanted) {
  const double ratio = static_cast<double>(points) / std::max(wanted, 1);
  const double factor = std::clamp(std::sqrt(ratio), 0.8, 1.25);
  return std::clamp(factor * distance_px, kMinDistance, kMaxDistance);
}

}  // namespace mba_vo
