#include "mba_vo/mapping/window_point_activation.h"

#include <algorithm>
#include <cmath>

namespace mba_vo {
namespace {

constexpr double kMaxDepthFactor = 2.0;    // by which one step may change the inverse depth
constexpr double kMinRelativeStep = 1e-4;  // of the inverse depth

}  // namespace

/// Gauss-Newton system of one inverse depth.
struct WindowPointActivation::DepthSystem {
  double cost = 0.0;
  double H = 0.0;
  double b = 0.0;
};

WindowPointActivation::DepthSystem WindowPointActivation::evaluate(const WindowState& state,
                                                                   const std::vector<PairGeometry>& pairs,
                                                                   bool place_pixels, PointState& point) const {
  DepthSystem total;
  PatchPath path;
  PatchMoments moments;
  ResidualSystem system;
  for (PatchResidual& residual : point.residuals) {
    const PairGeometry& pair = pairs[static_cast<std::size_t>(residual.target)];
    if (place_pixels) placePixels(pair, point.pixel, point.inverse_depth, residual_options_, residual);
    if (!residual.has_pixels || !pair.path->make(residual.centre.cast<double>(), point.inverse_depth, path) ||
        !evaluatePatch(pair, path, residual, residual_options_, moments)) {
      // Leaving an image never pays: the energy before the step, if any, still counts.
      if (!std::isnan(residual.energy)) {
        total.cost += std::min(static_cast<double>(residual.energy), state.keyframe(residual.target).outlier_energy);
      }
      continue;
    }
    residual.energy = moments.energy;
    total.cost += std::min(static_cast<double>(moments.energy), state.keyframe(residual.target).outlier_energy);
    if (!state.isGood(residual)) continue;
    assembleSystem(moments, path, pair.blurred, system);
    total.H += system.H_depth;
    total.b += system.b_depth;
  }
  return total;
}

bool WindowPointActivation::acceptable(const WindowState& state, const PointState& point,
                                       const DepthSystem& system) const {
  const auto inside = std::count_if(point.residuals.begin(), point.residuals.end(),
                                    [](const PatchResidual& r) { return std::isfinite(r.energy); });
  const int good = state.goodResiduals(point);
  return good >= options_.min_good_residuals && good >= options_.min_good_fraction * static_cast<double>(inside) &&
         system.H * point.inverse_depth * point.inverse_depth >= options_.min_relative_information;
}

std::optional<PointState> WindowPointActivation::activate(const WindowState& state, int host,
                                                          const Eigen::Vector2d& pixel, double inverse_depth) const {
  PointState point;
  point.host = host;
  point.pixel = pixel;
  point.inverse_depth = inverse_depth;
  std::vector<PairGeometry> pairs(static_cast<std::size_t>(state.size()));
  for (int t = 0; t < state.size(); ++t) {
    if (t == host) continue;
    pairs[static_cast<std::size_t>(t)] = makePairGeometry(state.keyframe(host), state.keyframe(t), reblur_targets_);
    PatchResidual residual;
    residual.target = t;
    point.residuals.push_back(residual);
  }
  // Pixels move with the point between steps; before and after one step the same are compared.
  DepthSystem system = evaluate(state, pairs, true, point);
  double lambda = 1e-3;
  for (int i = 0; i < options_.max_iterations && system.H > 0.0; ++i) {
    PointState trial = point;
    const double factor = 1.0 - system.b / (system.H * (1.0 + lambda)) / point.inverse_depth;
    trial.inverse_depth *= std::clamp(factor, 1.0 / kMaxDepthFactor, kMaxDepthFactor);
    if (evaluate(state, pairs, false, trial).cost >= system.cost) {
      lambda = std::max(lambda, 0.1) * 5.0;
      continue;
    }
    point = std::move(trial);
    system = evaluate(state, pairs, true, point);
    lambda *= 0.1;
    if (std::abs(factor - 1.0) < kMinRelativeStep) break;
  }
  if (!acceptable(state, point, system)) return std::nullopt;
  point.information = system.H;
  return point;
}

}  // namespace mba_vo
