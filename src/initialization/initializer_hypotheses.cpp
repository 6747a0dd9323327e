#include "mba_vo/initialization/initializer_hypotheses.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mba_vo/geometry/median.h"

namespace mba_vo {
namespace {

constexpr double kInitialSigma = 0.4;          // [px]
constexpr double kEpipolarTolerance = 1.0;     // [px]
constexpr double kMinStartInverseDepth = 0.1;  // in units of the median
constexpr double kMaxStartInverseDepth = 5.0;
constexpr std::size_t kMaxStarts = 2;  // that are followed to the end
constexpr double kSameDepths = 0.05;   // median difference of inverse depths of one and the same solution

Bundle emptyBundle(const StructureProblem& problem) {
  Bundle bundle;
  bundle.camera = problem.camera;
  for (const Eigen::Vector2d& pixel : problem.reference_pixels) bundle.rays.push_back(problem.camera.unproject(pixel));
  bundle.inverse_depth.assign(bundle.rays.size(), 1.0);
  return bundle;
}

bool same(const Bundle& a, const Bundle& b) {
  std::vector<double> difference;
  for (std::size_t p = 0; p < a.inverse_depth.size(); ++p) {
    difference.push_back(std::abs(a.inverse_depth[p] - b.inverse_depth[p]));
  }
  return median(std::move(difference)) < kSameDepths;
}

/// Two views refined from one relative pose.
struct TwoViewStart {
  Bundle bundle;
  double cost = 0.0;
};

TwoViewStart refineTwoViews(const StructureProblem& problem, BundleView view, const SE3& T_view_reference) {
  TwoViewStart start;
  start.bundle = emptyBundle(problem);
  view.T_view_reference = T_view_reference;
  for (std::size_t p = 0; p < view.observed.size(); ++p) {
    if (!view.observed[p]) continue;
    const Eigen::Vector3d ray = problem.camera.unproject(view.pixel[p]);
    start.bundle.inverse_depth[p] = triangulateInverseDepth(T_view_reference, start.bundle.rays[p], ray);
  }
  start.bundle.views.push_back(std::move(view));
  BundleOptions options;
  options.max_iterations = 6;
  start.cost = optimizeBundle(start.bundle, options).final_cost;
  normalizeScale(start.bundle);
  const std::vector<char>& observed = start.bundle.views.front().observed;
  for (std::size_t p = 0; p < observed.size(); ++p) {
    double& w = start.bundle.inverse_depth[p];
    w = observed[p] ? std::clamp(w, kMinStartInverseDepth, kMaxStartInverseDepth) : 1.0;
  }
  return start;
}

/// The best starts, each of which differs from the others.
std::vector<TwoViewStart> makeStarts(const StructureProblem& problem, const std::vector<ViewGeometry>& geometry,
                                     const ViewSplit& split) {
  const BundleView widest = makeBundleView(problem, geometry, split.widest);
  const PixelMatches matches = matchesWithReference(problem, split.widest);
  std::vector<TwoViewStart> all;
  for (const SE3& T : relativePoseCandidates(problem.camera, matches, kEpipolarTolerance)) {
    all.push_back(refineTwoViews(problem, widest, T));
  }
  std::sort(all.begin(), all.end(), [](const TwoViewStart& a, const TwoViewStart& b) { return a.cost < b.cost; });
  std::vector<TwoViewStart> starts;
  for (TwoViewStart& candidate : all) {
    const auto alike = [&candidate](const TwoViewStart& other) { return same(candidate.bundle, other.bundle); };
    if (starts.size() == kMaxStarts) break;
    if (std::none_of(starts.begin(), starts.end(), alike)) starts.push_back(std::move(candidate));
  }
  return starts;
}

/// All views: poses from the start's points, then everything together.
Hypothesis follow(const StructureProblem& problem, const std::vector<ViewGeometry>& geometry, const ViewSplit& split,
                  const Bundle& start) {
  Hypothesis hypothesis;
  hypothesis.bundle.camera = start.camera;
  hypothesis.bundle.rays = start.rays;
  hypothesis.bundle.inverse_depth = start.inverse_depth;
  BundleOptions options;
  for (const std::size_t v : split.bundle) {
    BundleView view = makeBundleView(problem, geometry, v);
    if (v == split.widest) view.T_view_reference = start.views.front().T_view_reference;
    options.max_iterations = 8;
    optimizePose(start, view, options);
    hypothesis.bundle.views.push_back(std::move(view));
  }
  options.max_iterations = 15;
  hypothesis.cost = optimizeBundle(hypothesis.bundle, options).final_cost;
  normalizeScale(hypothesis.bundle);
  return hypothesis;
}

/// Seen from nearby, the scene turned inside out (w -> 2 - w) under the opposite sideways motion fits nearly as well.
/// Started from there, the bundle adjustment either comes back or finds the other minimum.
Hypothesis followReversed(const Hypothesis& from) {
  Hypothesis reversed = from;
  for (double& w : reversed.bundle.inverse_depth) {
    w = std::clamp(2.0 - w, kMinStartInverseDepth, kMaxStartInverseDepth);
  }
  BundleOptions options;
  for (BundleView& view : reversed.bundle.views) {
    const SE3& T = view.T_view_reference;
    // What the median plane's sideways motion looked like is now, to first order, a rotation with twice its flow; the
    // expansion by forward motion is no rotation and stays.
    const Eigen::Vector3d t = T.translation();
    Vector6 turn = Vector6::Zero();
    turn.tail<3>() << -2.0 * t.y(), 2.0 * t.x(), 0.0;
    view.T_view_reference = SE3(SE3::exp(turn).rotation() * T.rotation(), Eigen::Vector3d(-t.x(), -t.y(), t.z()));
    options.max_iterations = 5;
    optimizePose(reversed.bundle, view, options);
  }
  options.max_iterations = 12;
  reversed.cost = optimizeBundle(reversed.bundle, options).final_cost;
  normalizeScale(reversed.bundle);
  return reversed;
}

}  // namespace

BundleView makeBundleView(const StructureProblem& problem, const std::vector<ViewGeometry>& geometry,
                          std::size_t view) {
  BundleView result;
  Vector6 rotation;
  rotation << Eigen::Vector3d::Zero(), geometry[view].rotation.rotation;
  result.T_view_reference = SE3::exp(rotation);
  result.sigma = kInitialSigma;
  result.pixel = problem.views[view].pixel;
  result.observed = problem.views[view].tracked;
  return result;
}

BundleView nearestStart(const StructureProblem& problem, const std::vector<ViewGeometry>& geometry,
                        const ViewSplit& split, const Bundle& bundle, std::size_t view) {
  const auto distance = [view](std::size_t v) { return v > view ? v - view : view - v; };
  std::size_t nearest = 0;
  for (std::size_t k = 1; k < split.bundle.size(); ++k) {
    if (distance(split.bundle[k]) < distance(split.bundle[nearest])) nearest = k;
  }
  BundleView result = makeBundleView(problem, geometry, view);
  result.T_view_reference =
      SE3(result.T_view_reference.rotation(), bundle.views[nearest].T_view_reference.translation());
  return result;
}

std::optional<Hypothesis> bestHypothesis(const StructureProblem& problem, const std::vector<ViewGeometry>& geometry,
                                         const ViewSplit& split) {
  std::vector<Hypothesis> found;
  for (const TwoViewStart& start : makeStarts(problem, geometry, split)) {
    found.push_back(follow(problem, geometry, split, start.bundle));
  }
  if (found.empty()) return std::nullopt;
  const auto cheaper = [](const Hypothesis& a, const Hypothesis& b) { return a.cost < b.cost; };
  std::sort(found.begin(), found.end(), cheaper);
  found.push_back(followReversed(found.front()));
  std::sort(found.begin(), found.end(), cheaper);
  for (std::size_t i = 1; i < found.size(); ++i) {
    if (same(found[0].bundle, found[i].bundle)) continue;
    found[0].runner_up_ratio = std::min(found[0].runner_up_ratio, found[i].cost / std::max(1e-12, found[0].cost));
  }
  return found.front();
}

}  // namespace mba_vo
