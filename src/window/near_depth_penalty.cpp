#include "mba_vo/window/near_depth_penalty.h"

#include <algorithm>
#include <vector>

#include "mba_vo/geometry/median.h"

namespace mba_vo {
namespace {

constexpr double kWeight = 100.0;
constexpr double kFree = 4.0;      // times nearer than the median a point may be at no cost
constexpr double kNearest = 20.0;  // times nearer than the median no point can be

}  // namespace

NearDepthPenalty::NearDepthPenalty(const WindowState& state) {
  std::vector<double> inverse_depths;
  inverse_depths.reserve(state.points.size());
  for (const PointState& point : state.points) inverse_depths.push_back(point.inverse_depth);
  if (inverse_depths.empty()) return;
  median_ = median(std::move(inverse_depths));
}

double NearDepthPenalty::excess(const PointState& point) const {
  return std::max(0.0, point.inverse_depth - kFree * median_);
}

double NearDepthPenalty::cost(const WindowState& state) const {
  double sum = 0.0;
  for (const PointState& point : state.points) sum += excess(point) * excess(point);
  return kWeight / (median_ * median_) * sum;
}

void NearDepthPenalty::addTo(const PointState& point, Eigen::Index row, LinearizedWindow& system) const {
  if (!concerns(point)) return;
  const double information = kWeight / (median_ * median_);
  system.H_depth(row) += information;
  system.b_depth(row) += information * excess(point);
}

bool NearDepthPenalty::isPlausible(double inverse_depth) const { return inverse_depth < kNearest * median_; }

}  // namespace mba_vo
