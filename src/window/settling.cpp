#include "mba_vo/window/settling.h"

#include <algorithm>
#include <cmath>

namespace mba_vo {
namespace {

/// How a step changes where one keyframe sees what another one sees.
struct PairStep {
  double turn = 0.0;      // [rad]
  double way = 0.0;       // [m]
  double baseline = 0.0;  // between the two [m]
  double focal = 0.0;     // [px]
};

PairStep pairStep(const PairGeometry& pair, const Vector8& host, const Vector8& target) {
  const Vector8 step = target + pair.J_host * host;
  return {step.segment<3>(3).norm(), step.head<3>().norm(), pair.T_target_host.translation().norm(),
          std::max(pair.target_camera.fx, pair.target_camera.fy)};
}

double shift(const PairStep& pair, double inverse_depth, double depth_step) {  // [px]
  return pair.focal * (pair.turn + pair.way * inverse_depth + pair.baseline * std::abs(depth_step));
}

}  // namespace

std::vector<bool> hardlyMove(const WindowState& state, const std::vector<PairGeometry>& pairs,
                             const Eigen::VectorXd& keyframe_steps, const Eigen::VectorXd& depth_steps, double limit) {
  const auto stepOf = [&](int i) -> Vector8 { return keyframe_steps.segment<kKeyframeDim>(kKeyframeDim * i); };
  const int n = state.size();
  std::vector<PairStep> steps(pairs.size());
  for (int i = 0; i < static_cast<int>(pairs.size()); ++i) {
    const auto index = static_cast<std::size_t>(i);
    if (pairs[index].path) steps[index] = pairStep(pairs[index], stepOf(i / n), stepOf(i % n));
  }
  std::vector<bool> result(state.points.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    const PointState& point = state.points[i];
    const double depth_step = depth_steps(static_cast<Eigen::Index>(i));
    result[i] = std::all_of(point.residuals.begin(), point.residuals.end(), [&](const PatchResidual& residual) {
      const PairStep& pair = steps[static_cast<std::size_t>(point.host * n + residual.target)];
      return shift(pair, point.inverse_depth, depth_step) < limit;
    });
  }
  return result;
}

}  // namespace mba_vo
