#include "mba_vo/tracking/point_subset.h"

#include <algorithm>
#include <cmath>

namespace mba_vo {
namespace {

constexpr double kPatchOverlap = 0.75;  // cells are this fraction of a patch wide on coarse levels
constexpr double kEnough = 0.6;         // of the points asked for
constexpr double kFinerCell = 0.8;      // where there are not enough, of the cell before

float squaredGradient(const cv::Mat1f& image, const Eigen::Vector2d& pixel) {
  const int x = std::clamp(static_cast<int>(std::floor(pixel.x() + 0.5)), 1, image.cols - 2);
  const int y = std::clamp(static_cast<int>(std::floor(pixel.y() + 0.5)), 1, image.rows - 2);
  const float gx = image(y, x + 1) - image(y, x - 1);
  const float gy = image(y + 1, x) - image(y - 1, x);
  const float g2 = gx * gx + gy * gy;
  return std::isfinite(g2) ? g2 : 0.0F;
}

/// The point with the largest gradient of every cell.
std::vector<int> onePerCell(const Reference& reference, const cv::Mat1f& image, double scale, double cell) {
  const PinholeCamera& camera = reference.pyramid->level(0).camera;
  const int columns = static_cast<int>(std::ceil(camera.width / cell));
  const int rows = static_cast<int>(std::ceil(camera.height / cell));
  std::vector<int> best(static_cast<std::size_t>(columns * rows), -1);
  std::vector<float> best_gradient(best.size(), -1.0F);
  for (std::size_t i = 0; i < reference.points.size(); ++i) {
    const Eigen::Vector2d pixel = reference.points[i].pixel.cast<double>();
    const int column = std::clamp(static_cast<int>(pixel.x() / cell), 0, columns - 1);
    const int row = std::clamp(static_cast<int>(pixel.y() / cell), 0, rows - 1);
    const auto c = static_cast<std::size_t>(row * columns + column);
    const float gradient = squaredGradient(image, (pixel.array() + 0.5) * scale - 0.5);
    if (gradient > best_gradient[c]) {
      best_gradient[c] = gradient;
      best[c] = static_cast<int>(i);
    }
  }
  best.erase(std::remove(best.begin(), best.end(), -1), best.end());
  return best;
}

}  // namespace

std::vector<int> selectEvenSubset(const Reference& reference, int level, int patch_side, int max_points) {
  const PinholeCamera& camera = reference.pyramid->level(0).camera;
  const cv::Mat1f& image = reference.pyramid->level(level).intensity;
  const double scale = 1.0 / (1 << level);
  const double area_per_point = static_cast<double>(camera.width) * camera.height / max_points;
  const double smallest = kPatchOverlap * patch_side / scale;  // [px of level 0]
  double cell = std::max(std::sqrt(area_per_point), smallest);
  std::vector<int> chosen = onePerCell(reference, image, scale, cell);
  // On a fast turn only a part of the image has points yet: they are taken more densely there.
  while (static_cast<double>(chosen.size()) < kEnough * max_points && cell > smallest) {
    cell = std::max(kFinerCell * cell, smallest);
    chosen = onePerCell(reference, image, scale, cell);
  }
  return chosen;
}

}  // namespace mba_vo
