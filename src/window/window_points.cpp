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

void setSlopes(WindowState& state, const std::vector<WindowPoint>& points,
               const std::function<std::optional<Eigen::Vector2d>(const WindowPoint&)>& slopeOf) {
  auto own = state.points.begin();
  for (const WindowPoint& point : points) {
    own = std::find_if(own, state.points.end(), [&](const PointState& p) { return p.id == point.id; });
    if (own == state.points.end()) return;
    if (const auto slope = slopeOf(point)) own->slope = *slope;
  }
}

}  // namespace mba_vo
