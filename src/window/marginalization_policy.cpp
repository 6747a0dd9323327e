#include "mba_vo/window/marginalization_policy.h"

#include <algorithm>
#include <cmath>

namespace mba_vo {
namespace {

constexpr int kRecent = 10;  // keyframes for which a turn goes on to count

constexpr double kRelativeEpsilon = 1e-5;  // of the window's extent, keeps 1 / d finite

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

/// Good residuals of points of one keyframe (row) in another (column).
Eigen::MatrixXi countResiduals(const WindowState& state) {
  Eigen::MatrixXi counts = Eigen::MatrixXi::Zero(state.size(), state.size());
  for (const PointState& point : state.points) {
    for (const PatchResidual& residual : point.residuals) {
      if (state.isGood(residual)) ++counts(point.host, residual.target);
    }
  }
  return counts;
}

int maxResiduals(const WindowState& state, const MarginalizationPolicyOptions& options) {
  const auto begin = state.keyframes.end() - std::min(kRecent, state.size());
  const bool turned = std::any_of(begin, state.keyframes.end(), [&](const KeyframeState& keyframe) {
    return keyframe.blur_length_px >= options.long_blur_px;
  });
  return turned ? std::max(options.max_residuals, options.max_residuals_blurred) : options.max_residuals;
}

}  // namespace

std::vector<int> chooseKeyframesToMarginalize(const WindowState& state, const MarginalizationPolicyOptions& options) {
  const Eigen::MatrixXi residuals = countResiduals(state);
  const int max_residuals = maxResiduals(state, options);
  std::vector<int> remaining, marginalized;
  for (int i = 0; i < state.size(); ++i) remaining.push_back(i);
  const auto areTooMany = [&] {
    const auto count = static_cast<int>(remaining.size());
    return count >= options.max_keyframes ||
           (count >= options.min_keyframes && residuals(remaining, remaining).sum() > max_residuals);
  };
  while (remaining.size() > 2 && areTooMany()) {
    const std::size_t crowding = mostCrowding(state, remaining);
    marginalized.push_back(remaining[crowding]);
    remaining.erase(remaining.begin() + static_cast<std::ptrdiff_t>(crowding));
  }
  return marginalized;
}

}  // namespace mba_vo
