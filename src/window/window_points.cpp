#include "mba_vo/window/window_points.h"

#include <algorithm>

namespace mba_vo {
namespace {

/// `positions`: of the keyframes' cameras.
WindowPoint describe(const WindowState& state, const PointState& point, const std::vector<Eigen::Vector3d>& positions) {
  WindowPoint out;
  const KeyframeState& host = state.keyframe(point.host);
  out.id = point.id;
  out.host = host.id;
  out.pixel = point.pixel;
  out.inverse_depth = point.inverse_depth;
  out.variance = 1.0 / std::max(point.information, 1e-12);
  out.visible_in_newest = point.host == state.size() - 1;
  const Eigen::Vector3d& position = positions[static_cast<std::size_t>(point.host)];
  for (const PatchResidual& residual : point.residuals) {
    if (!state.isGood(residual)) continue;
    ++out.good_residuals;
    const Eigen::Vector3d baseline = positions[static_cast<std::size_t>(residual.target)] - position;
    out.relative_baseline = std::max(out.relative_baseline, baseline.norm() * point.inverse_depth);
    out.visible_in_newest = out.visible_in_newest || residual.target == state.size() - 1;
  }
  return out;
}

}  // namespace

std::vector<WindowPoint> describePoints(const WindowState& state) {
  std::vector<Eigen::Vector3d> positions;
  for (const KeyframeState& k : state.keyframes) positions.push_back(k.T_map_keyframe().translation());
  std::vector<WindowPoint> points;
  points.reserve(state.points.size());
  for (const PointState& point : state.points) points.push_back(describe(state, point, positions));
  return points;
}

std::vector<double> inverseDepths(const WindowState& state) {
  std::vector<double> inverse_depths;
  inverse_depths.reserve(state.points.size());
  for (const PointState& point : state.points) inverse_depths.push_back(point.inverse_depth);
  return inverse_depths;
}

void setSlopes(WindowState& state, const std::vector<std::optional<Eigen::Vector2d>>& slopes) {
  for (std::size_t i = 0; i < slopes.size(); ++i) {
    if (slopes[i]) state.points[i].slope = *slopes[i];
  }
}

}  // namespace mba_vo
