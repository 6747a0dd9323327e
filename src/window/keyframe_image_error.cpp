#include "mba_vo/window/keyframe_image_error.h"

#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "mba_vo/solver/residual_spread.h"

namespace mba_vo {
namespace {

constexpr std::size_t kLeastPatches = 50;

/// The keyframes, and the points as if the host had been the first to see them.
WindowState stateOf(const WindowState& state, int host, const std::vector<ReferencePoint>& points) {
  WindowState trial;
  trial.keyframes = state.keyframes;
  for (const ReferencePoint& p : points) {
    PointState point;
    point.host = host;
    point.pixel = p.pixel.cast<double>();
    point.inverse_depth = static_cast<double>(p.inverse_depth);
    for (int target = 0; target < state.size(); ++target) {
      if (target == host) continue;
      point.residuals.emplace_back();
      point.residuals.back().target = target;
    }
    trial.points.push_back(std::move(point));
  }
  return trial;
}

/// The spread of all residuals over the gradient of what they were compared with [px].
std::optional<double> errorOf(WindowState& trial, const WindowLinearizer& linearizer) {
  std::vector<int> all(trial.points.size());
  std::iota(all.begin(), all.end(), 0);
  WindowEvaluation evaluation;
  linearizer.evaluate(trial, all, evaluation, std::numeric_limits<float>::infinity());
  std::vector<float> sizes;
  double squared_gradient = 0.0;
  std::size_t patch = 0;
  for (const PointState& point : trial.points) {
    for (const PatchResidual& residual : point.residuals) {
      const PatchComparison& comparison = evaluation.patches[patch++];
      if (std::isnan(residual.trial_energy)) continue;
      for (std::size_t k = 0; k < kResidualPixels; ++k) {
        sizes.push_back(std::abs(comparison.r[k]));
        squared_gradient += std::pow(comparison.gx[k], 2.0) + std::pow(comparison.gy[k], 2.0);
      }
    }
  }
  if (sizes.size() < kLeastPatches * kResidualPixels || !(squared_gradient > 0.0)) return std::nullopt;
  const double gradient = std::sqrt(0.5 * squared_gradient / static_cast<double>(sizes.size()));
  return residualSpread(sizes) / gradient;
}

}  // namespace

std::optional<KeyframeImageError> compareHostImages(const WindowState& state, int host,
                                                    const std::shared_ptr<const ImagePyramid>& sharp,
                                                    const std::vector<ReferencePoint>& points,
                                                    const WindowLinearizer& linearizer) {
  WindowState trial = stateOf(state, host, points);
  const std::optional<double> own = errorOf(trial, linearizer);
  trial.replaceImage(host, sharp);
  const std::optional<double> other = errorOf(trial, linearizer);
  if (!own || !other) return std::nullopt;
  return KeyframeImageError{*own, *other};
}

}  // namespace mba_vo
