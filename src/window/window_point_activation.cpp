#include "mba_vo/window/window_point_activation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mba_vo/window/point_activation.h"

namespace mba_vo {
namespace {

constexpr double kMaxRefinedFactor = 2.0;  // by which one step may change the inverse depth
constexpr float kMaxPointDrift = 0.75F;    // [px] beyond it a residual gets new pixels

bool hasDrifted(const PatchResidual& residual) { return residual.has_pixels && residual.drift > kMaxPointDrift; }

}  // namespace

WindowPointActivation::Evaluation WindowPointActivation::evaluate(const WindowState& state,
                                                                  const std::vector<PairGeometry>& pairs,
                                                                  bool place_pixels, PointState& point) const {
  Evaluation total;
  PatchPath path;
  PatchComparison comparison;
  for (PatchResidual& residual : point.residuals) {
    const PairGeometry& pair = pairs[static_cast<std::size_t>(point.host * state.size() + residual.target)];
    if (!place_pixels && std::isnan(residual.energy)) continue;  // what could not be seen before the step
    const double limit = state.keyframe(residual.target).outlier_energy;
    if (place_pixels && (!residual.has_pixels || hasDrifted(residual))) {
      placePixels(pair, point.pixel, point.inverse_depth, residual_options_, residual, point.slope);
    }
    const bool seen = residual.has_pixels && makePath(pair, residual.centre, point, path);
    if (seen) residual.drift = projectionDrift(path, point.pixel);
    if (!seen || !comparePatch(pair, path, residual, residual_options_, comparison)) {
      // Leaving an image never pays: the energy before the step, if any, still counts.
      if (!std::isnan(residual.energy)) total.cost += std::min(static_cast<double>(residual.energy), limit);
      continue;
    }
    residual.energy = comparison.energy;
    total.cost += std::min(static_cast<double>(comparison.energy), limit);
    if (!state.isGood(residual)) continue;
    const DepthSystem system = assembleDepth(comparison, path, pair.blurred);
    total.H += system.H;
    total.b += system.b;
  }
  const MeasuredDepthTerm measured = measuredDepthTerm(point.measured, point.inverse_depth, state.meanPrecision());
  total.cost += measured.cost;
  total.H += measured.H;
  total.b += measured.b;
  return total;
}

bool WindowPointActivation::acceptable(const WindowState& state, const PointState& point,
                                       const Evaluation& evaluation) const {
  const auto inside = std::count_if(point.residuals.begin(), point.residuals.end(),
                                    [](const PatchResidual& r) { return std::isfinite(r.energy); });
  const int good = state.goodResiduals(point);
  return good >= options_.min_good_residuals && good >= options_.min_good_fraction * static_cast<double>(inside) &&
         evaluation.H * point.inverse_depth * point.inverse_depth >= options_.min_relative_information;
}

bool WindowPointActivation::admit(const WindowState& state, const std::vector<PairGeometry>& pairs, double sigma,
                                  Residuals& waiting, PointState& point) const {
  const auto isOutOfReach = [&](const PatchResidual& residual) {
    const PairGeometry& pair = pairs[static_cast<std::size_t>(point.host * state.size() + residual.target)];
    const auto here = projectIntoTarget(pair, point.pixel, point.inverse_depth);
    const auto off = projectIntoTarget(pair, point.pixel, point.inverse_depth + sigma);
    return !here || !off || (*off - *here).norm() >= options_.reach_px;
  };
  const auto within = std::stable_partition(waiting.begin(), waiting.end(), isOutOfReach);
  if (within == waiting.end()) return false;
  point.residuals.insert(point.residuals.end(), within, waiting.end());
  waiting.erase(within, waiting.end());
  return true;
}

WindowPointActivation::Evaluation WindowPointActivation::refine(const WindowState& state,
                                                                const std::vector<PairGeometry>& pairs,
                                                                PointState& point) const {
  // Pixels follow the point between steps; before and after one step the same are compared.
  Evaluation current = evaluate(state, pairs, true, point);
  double lambda = 1e-3;
  PointState trial;
  for (int i = 0; i < options_.max_iterations && current.H > 0.0; ++i) {
    const double factor = 1.0 - current.b / (current.H * (1.0 + lambda)) / point.inverse_depth;
    if (std::abs(factor - 1.0) < options_.min_relative_step) break;
    trial = point;
    trial.inverse_depth *= std::clamp(factor, 1.0 / kMaxRefinedFactor, kMaxRefinedFactor);
    const Evaluation tried = evaluate(state, pairs, false, trial);
    if (tried.cost >= current.cost) {
      lambda = std::max(lambda, 0.1) * 5.0;
      continue;
    }
    std::swap(point, trial);
    const bool drifted = std::any_of(point.residuals.begin(), point.residuals.end(), hasDrifted);
    current = drifted ? evaluate(state, pairs, true, point) : tried;
    lambda *= 0.1;
  }
  return current;
}

std::optional<PointState> WindowPointActivation::activate(const WindowState& state,
                                                          const std::vector<PairGeometry>& pairs,
                                                          const NewPoint& candidate) const {
  if (!(candidate.inverse_depth > 0.0) || !std::isfinite(candidate.inverse_depth)) return std::nullopt;
  PointState point;
  point.host = state.indexOf(candidate.host);
  point.pixel = candidate.pixel;
  point.inverse_depth = candidate.inverse_depth;
  point.slope = candidate.slope;
  point.measured = candidate.measured;
  Residuals waiting(state.keyframes.size() - 1);
  for (int t = 0; t < state.size(); ++t) {
    if (t != point.host) waiting[static_cast<std::size_t>(t < point.host ? t : t - 1)].target = t;
  }
  Evaluation found;
  for (double sigma = candidate.sigma; admit(state, pairs, sigma, waiting, point);) {
    found = refine(state, pairs, point);
    sigma = 1.0 / std::sqrt(1.0 / (sigma * sigma) + found.H / kResidualVariance);
  }
  if (!acceptable(state, point, found)) return std::nullopt;
  point.information = found.H;
  // Keyframes in which it cannot be seen now will hardly ever see it: on fast turns these are up to half.
  auto& residuals = point.residuals;
  residuals.erase(
      std::remove_if(residuals.begin(), residuals.end(), [](const PatchResidual& r) { return std::isnan(r.energy); }),
      residuals.end());
  std::sort(residuals.begin(), residuals.end(),
            [](const PatchResidual& a, const PatchResidual& b) { return a.target < b.target; });
  return point;
}

}  // namespace mba_vo
