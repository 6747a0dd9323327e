#include "mba_vo/pose_graph/depth_ratio.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "mba_vo/geometry/median.h"

namespace mba_vo {
namespace {

constexpr double kCell = 8.0;                // [px] of the grid that points are found by
constexpr double kNearest = 4.0;             // [px] to a point whose depth is taken for that of the place
constexpr double kLargestDepthSigma = 0.05;  // of a point that is used, relative to its depth
constexpr int kRounds = 3;                   // the scale decides where points are seen
constexpr double kNormalSpread = 1.4826;     // standard deviation over the median absolute deviation
constexpr double kIndependentPart = 0.1;     // of the points: neighbours share their errors
constexpr double kLeastSigma = 0.003;        // what depths of one keyframe have wrong in common

bool isKnown(const ReferencePoint& point) {
  return point.inverse_depth > 0.0F &&
         std::sqrt(static_cast<double>(point.variance)) < kLargestDepthSigma * static_cast<double>(point.inverse_depth);
}

/// Finds points of a keyframe by their place in the image.
class PointGrid {
 public:
  explicit PointGrid(const ArchivedKeyframe& keyframe)
      : columns_(static_cast<int>(keyframe.camera.width / kCell) + 1),
        rows_(static_cast<int>(keyframe.camera.height / kCell) + 1),
        cells_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {
    for (const ReferencePoint& point : keyframe.reference.points) {
      const int cell = cellOf(point.pixel.x(), point.pixel.y());
      if (cell >= 0 && isKnown(point)) cells_[static_cast<std::size_t>(cell)].push_back(&point);
    }
  }

  const ReferencePoint* nearest(const Eigen::Vector2d& pixel) const {
    const ReferencePoint* best = nullptr;
    double best_distance = kNearest;
    for (const double dy : {-kNearest, kNearest}) {
      for (const double dx : {-kNearest, kNearest}) {  // kNearest is half a cell: no more than four can be near
        const int cell = cellOf(pixel.x() + dx, pixel.y() + dy);
        if (cell < 0) continue;
        for (const ReferencePoint* point : cells_[static_cast<std::size_t>(cell)]) {
          const double distance = (point->pixel.cast<double>() - pixel).norm();
          if (distance >= best_distance) continue;
          best_distance = distance;
          best = point;
        }
      }
    }
    return best;
  }

 private:
  int cellOf(double x, double y) const {
    const int column = static_cast<int>(std::floor(x / kCell));
    const int row = static_cast<int>(std::floor(y / kCell));
    return column < 0 || row < 0 || column >= columns_ || row >= rows_ ? -1 : row * columns_ + column;
  }
  int columns_, rows_;
  std::vector<std::vector<const ReferencePoint*>> cells_;
};

/// For each point of `from` the logarithm of the scale with which it would lie at the depth that `to` has there.
void collect(const ArchivedKeyframe& from, const ArchivedKeyframe& to, const PointGrid& grid, const SE3& T_to_from,
             double scale, double sign, std::vector<double>& logs) {
  for (const ReferencePoint& point : from.reference.points) {
    if (!isKnown(point)) continue;
    const Eigen::Vector3d in_from =
        from.camera.unproject(point.pixel.cast<double>()) / static_cast<double>(point.inverse_depth);
    const Eigen::Vector3d turned = T_to_from.rotation() * in_from;
    const Eigen::Vector3d in_to = scale * turned + T_to_from.translation();
    if (in_to.z() <= 0.0 || turned.z() <= 0.0) continue;
    const ReferencePoint* there = grid.nearest(to.camera.project(in_to));
    if (there == nullptr) continue;
    const double depth = 1.0 / static_cast<double>(there->inverse_depth);
    const double ratio = (depth - T_to_from.translation().z()) / turned.z();
    if (ratio > 0.0) logs.push_back(sign * std::log(ratio));
  }
}

}  // namespace

ScaleEstimate compareDepths(const ArchivedKeyframe& a, const ArchivedKeyframe& b, const SE3& T_a_b) {
  const PointGrid in_a(a), in_b(b);
  ScaleEstimate estimate;
  for (int round = 0; round < kRounds; ++round) {
    const double scale = std::exp(estimate.log_scale);
    const SE3 T_b_a = T_a_b.inverse();
    const SE3 in_units_of_b(T_b_a.rotation(), T_b_a.translation() / scale);
    std::vector<double> logs;
    collect(b, a, in_a, T_a_b, scale, 1.0, logs);
    collect(a, b, in_b, in_units_of_b, 1.0 / scale, -1.0, logs);
    estimate.points = static_cast<int>(logs.size());
    if (logs.empty()) return estimate;
    estimate.log_scale = median(logs);
    for (double& value : logs) value = std::abs(value - estimate.log_scale);
    const double independent = std::max(1.0, kIndependentPart * estimate.points);
    estimate.sigma = std::hypot(kLeastSigma, kNormalSpread * median(logs) / std::sqrt(independent));
  }
  return estimate;
}

}  // namespace mba_vo
