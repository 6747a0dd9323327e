#include "mba_vo/mapping/keyframe_retirement.h"

#include <algorithm>
#include <cmath>

namespace mba_vo {
namespace {

constexpr double kRelativeEpsilon = 1e-5;  // of the window's extent, keeps 1 / d finite

bool seenByNewest(const WindowState& state, const PointState& point) {
  return std::any_of(point.residuals.begin(), point.residuals.end(),
                     [&](const PatchResidual& r) { return r.target == state.size() - 1 && state.isGood(r); });
}

/// The remaining keyframe with the largest distance score.
std::size_t mostCrowding(const WindowState& state, const std::vector<int>& remaining) {
  const auto position = [&](int i) { return state.keyframe(i).T_map_keyframe().translation(); };
  const Eigen::Vector3d newest = position(state.size() - 1);
  double extent = 0.0;
  for (const int i : remaining) extent = std::max(extent, (position(i) - newest).norm());
  const double epsilon = std::max(kRelativeEpsilon * extent, 1e-300);
  std::size_t best = 0;
  double best_score = -1.0;
  for (std::size_t a = 0; a + 2 < remaining.size(); ++a) {
    double crowd = 0.0;
    for (std::size_t b = 0; b + 1 < remaining.size(); ++b) {
      if (a != b) crowd += 1.0 / ((position(remaining[a]) - position(remaining[b])).norm() + epsilon);
    }
    const double score = std::sqrt((position(remaining[a]) - newest).norm()) * crowd;
    if (score > best_score) {
      best_score = score;
      best = a;
    }
  }
  return best;
}

}  // namespace

double visibleFraction(const WindowState& state, int keyframe) {
  const auto visible = std::count_if(state.points.begin(), state.points.end(),
                                     [&](const PointState& p) { return p.host == keyframe && seenByNewest(state, p); });
  return static_cast<double>(visible) / std::max(1, state.keyframe(keyframe).points_added);
}

std::vector<int> keyframesToRetire(const WindowState& state, const KeyframeRetirementOptions& options) {
  std::vector<int> remaining, retired;
  const int removable = state.size() - std::min(options.min_keyframes, options.max_keyframes - 1);
  for (int i = 0; i < state.size(); ++i) {
    const bool retire = i + 2 < state.size() && static_cast<int>(retired.size()) < removable &&
                        visibleFraction(state, i) < options.min_visible;
    (retire ? retired : remaining).push_back(i);
  }
  while (static_cast<int>(remaining.size()) > options.max_keyframes - 1 && remaining.size() > 2) {
    const std::size_t crowding = mostCrowding(state, remaining);
    retired.push_back(remaining[crowding]);
    remaining.erase(remaining.begin() + static_cast<std::ptrdiff_t>(crowding));
  }
  return retired;
}

}  // namespace mba_vo
