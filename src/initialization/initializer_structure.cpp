#include "mba_vo/initialization/initializer_structure.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "mba_vo/geometry/median.h"
#include "mba_vo/initialization/initializer_hypotheses.h"
#include "mba_vo/initialization/initializer_rows.h"
#include "mba_vo/initialization/initializer_views.h"

namespace mba_vo {
namespace {

constexpr std::size_t kMinViews = 5;
constexpr double kRotationOnly = 0.2;  // share of the flow of min_parallax that rotation must leave unexplained
constexpr double kOutlierSigmas = 3.5;
constexpr double kMaxPointSigma = 0.5;        // of an inverse depth, relative; beyond it a point is no good
constexpr double kClearWinner = 1.15;         // cost of the best different solution over that of the best
constexpr double kMinPositive = 0.9;          // share of the points that must lie in front of the reference
constexpr double kValidationTolerance = 1.5;  // [px]
constexpr double kMinExplained = 0.7;         // share of points of a held-out view, and of the held-out views
// Rendered rolling shutters of 20 and 26 ms had cost ratios of 0.04 to 0.68, a real one 0.59 to 0.88, global ones more
// than 0.96 with readouts under 2 ms. A lens that is 1.5 % and 4 px wrong looked like a readout of 2 to 5 ms, with
// ratios from 0.77 on.
constexpr double kRollingShutter = 0.9;  // cost with a row time over that without
constexpr double kLeastReadout = 6e-3;   // [s] of all rows
// Of min_parallax, below which no row time is looked for: with it, parallax grew by 5 to 10 %.
constexpr double kHopelessParallax = 0.75;

std::string format(const char* text, double a, double b) {
  char buffer[160];
  std::snprintf(buffer, sizeof(buffer), text, a, b);
  return buffer;
}

/// Forgets observations that do not fit and points that keep fewer than three.
void removeOutliers(Bundle& bundle) {
  std::vector<int> count(bundle.rays.size(), 0);
  for (BundleView& view : bundle.views) {
    const std::vector<double> errors = reprojectionErrors(bundle, view);
    std::size_t k = 0;
    for (std::size_t p = 0; p < bundle.rays.size(); ++p) {
      if (!view.observed[p]) continue;
      if (errors[k++] > kOutlierSigmas * view.sigma) view.observed[p] = 0;
      count[p] += view.observed[p];
    }
  }
  for (BundleView& view : bundle.views) {
    for (std::size_t p = 0; p < bundle.rays.size(); ++p) {
      if (count[p] < 3) view.observed[p] = 0;
    }
  }
}

void refine(Bundle& bundle) {
  for (int round = 0; round < 2; ++round) {
    estimateSigmas(bundle);
    removeOutliers(bundle);
    BundleOptions options;
    options.max_iterations = 8;
    optimizeBundle(bundle, options);
    normalizeScale(bundle);
  }
  estimateSigmas(bundle);
}

int observations(const Bundle& bundle) {
  std::ptrdiff_t count = 0;
  for (const BundleView& view : bundle.views) count += std::count(view.observed.begin(), view.observed.end(), 1);
  return static_cast<int>(count);
}

double shareInFront(const Bundle& bundle) {
  const std::vector<double> variances = inverseDepthVariances(bundle);
  double positive = 0.0;
  double observed = 0.0;
  for (std::size_t p = 0; p < variances.size(); ++p) {
    if (!std::isfinite(variances[p])) continue;
    observed += 1.0;
    if (bundle.inverse_depth[p] > 0.0) positive += 1.0;
  }
  return positive / std::max(1.0, observed);
}

/// Poses of the views left out, and whether the structure explains them.
bool validate(const StructureProblem& problem, const std::vector<ViewGeometry>& geometry, const ViewSplit& split,
              const Bundle& bundle, StructureEstimate& estimate) {
  int explained_views = 0;
  std::vector<double> medians;
  for (const std::size_t v : split.held_out) {
    BundleView view = nearestStart(problem, geometry, split, bundle, v);
    optimizePose(bundle, view, BundleOptions());
    const std::vector<double> errors = reprojectionErrors(bundle, view);
    medians.push_back(median(errors));
    const double inside = static_cast<double>(
        std::count_if(errors.begin(), errors.end(), [](double e) { return e < kValidationTolerance; }));
    if (inside < kMinExplained * static_cast<double>(errors.size())) continue;
    ++explained_views;
    estimate.T_view_reference[v] = view.T_view_reference;
  }
  estimate.validation_error = median(medians);
  return explained_views >= kMinExplained * static_cast<double>(split.held_out.size());
}

void fillPoints(const Bundle& bundle, StructureEstimate& estimate) {
  estimate.inverse_depth = bundle.inverse_depth;
  estimate.variance = inverseDepthVariances(bundle);
  std::vector<double> relative;
  for (std::size_t p = 0; p < estimate.variance.size(); ++p) {
    const double w = bundle.inverse_depth[p];
    const double sigma = std::sqrt(estimate.variance[p]);
    if (w > 0.0 && std::isfinite(sigma)) relative.push_back(sigma / w);
    if (!(w > 0.0) || sigma > kMaxPointSigma * std::max(w, 1.0)) {
      estimate.variance[p] = std::numeric_limits<double>::infinity();
    } else {
      ++estimate.points;
    }
  }
  estimate.relative_depth_sigma = median(relative);
}

void fillMotion(const ViewSplit& split, const Bundle& bundle, StructureEstimate& estimate) {
  std::vector<double> translations, errors;
  for (std::size_t k = 0; k < split.bundle.size(); ++k) {
    estimate.T_view_reference[split.bundle[k]] = bundle.views[k].T_view_reference;
    translations.push_back(bundle.views[k].T_view_reference.inverse().translation().norm());
    errors.push_back(median(reprojectionErrors(bundle, bundle.views[k])));
  }
  std::sort(translations.begin(), translations.end());
  estimate.parallax = translations[translations.size() - 2];  // the largest may be a bad view
  estimate.reprojection_error = median(errors);
}

std::string judge(const StructureEstimate& e, const StructureConfig& config, double share_in_front, double ambiguity,
                  bool validated) {
  if (share_in_front < kMinPositive)
    return format("structure behind the camera (%.0f %% in front)", 1e2 * share_in_front, 0);
  if (ambiguity < kClearWinner)
    return format("motion still ambiguous (second best fits %.2f times as badly)", ambiguity, 0);
  if (e.parallax < config.min_parallax) {
    return format("only rotation so far (parallax %.1f %%, %.1f %% needed)", 1e2 * e.parallax,
                  1e2 * config.min_parallax);
  }
  if (e.points < config.min_points)
    return format("too few good points (%.0f, %.0f needed)", e.points, config.min_points);
  if (e.relative_depth_sigma > config.max_relative_depth_sigma) {
    return format("depths still uncertain (%.0f %%, %.0f %% needed)", 1e2 * e.relative_depth_sigma,
                  1e2 * config.max_relative_depth_sigma);
  }
  if (!validated)
    return format("structure does not explain the frames left out (error %.2f px)", e.validation_error, 0);
  return "";
}

/// What a global shutter's tracks say.
struct Solution {
  StructureEstimate estimate;
  std::vector<std::size_t> bundle_views;
  std::optional<Hypothesis> best;
};

Solution solve(const StructureProblem& problem, const StructureConfig& config) {
  Solution solution;
  StructureEstimate& estimate = solution.estimate;
  estimate.T_view_reference.resize(problem.views.size());
  const std::vector<ViewGeometry> geometry = analyseViews(problem, config);
  const ViewSplit split = splitViews(problem, geometry, config);
  solution.bundle_views = split.bundle;
  if (split.bundle.size() < kMinViews - 2 || split.bundle.size() + split.held_out.size() < kMinViews) {
    estimate.reason = format("too few frames see the reference (%.0f, %.0f needed)",
                             static_cast<double>(split.bundle.size() + split.held_out.size()), kMinViews);
    return solution;
  }
  estimate.rotation_residual = geometry[split.widest].rotation.median_residual;
  const double flow = estimate.rotation_residual / problem.camera.fx;
  if (flow < kRotationOnly * config.min_parallax) {
    estimate.reason = format("only rotation so far (it leaves %.2f px of flow unexplained, %.2f needed)",
                             estimate.rotation_residual, kRotationOnly * config.min_parallax * problem.camera.fx);
    return solution;
  }
  solution.best = bestHypothesis(problem, geometry, split);
  if (!solution.best) {
    estimate.reason = "no motion fits the tracks";
    return solution;
  }
  Bundle& bundle = solution.best->bundle;
  estimate.residuals = observations(bundle);
  refine(bundle);
  fillPoints(bundle, estimate);
  fillMotion(split, bundle, estimate);
  const bool validated = validate(problem, geometry, split, bundle, estimate);
  estimate.reason = judge(estimate, config, shareInFront(bundle), solution.best->runner_up_ratio, validated);
  estimate.accepted = estimate.reason.empty();
  return solution;
}

}  // namespace

StructureEstimate estimateStructure(const StructureProblem& problem, const StructureConfig& config) {
  if (problem.camera.row_time != 0.0) {
    return solve(withGlobalShutter(problem, problem.camera.row_time), config).estimate;
  }
  const Solution global = solve(problem, config);
  if (!config.find_row_time || global.estimate.parallax < kHopelessParallax * config.min_parallax) {
    return global.estimate;
  }
  const RowTimeFit rows = fitRowTime(problem, global.bundle_views, global.best->bundle);
  const double readout = std::abs(rows.row_time) * problem.camera.height;
  if (rows.cost_ratio > kRollingShutter || readout < kLeastReadout) return global.estimate;
  StructureEstimate rolling = solve(withGlobalShutter(problem, rows.row_time), config).estimate;
  rolling.row_time = rows.row_time;
  rolling.residuals += global.estimate.residuals;
  return rolling;
}

}  // namespace mba_vo
