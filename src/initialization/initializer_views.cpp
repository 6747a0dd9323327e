#include "mba_vo/initialization/initializer_views.h"

#include <algorithm>
#include <cmath>

namespace mba_vo {

PixelMatches matchesWithReference(const StructureProblem& problem, std::size_t view) {
  PixelMatches matches;
  const StructureView& v = problem.views[view];
  for (std::size_t p = 0; p < problem.reference_pixels.size(); ++p) {
    if (v.tracked[p]) matches.add(problem.reference_pixels[p], v.pixel[p]);
  }
  return matches;
}

std::vector<ViewGeometry> analyseViews(const StructureProblem& problem, const StructureConfig& config) {
  std::vector<ViewGeometry> geometry(problem.views.size());
  const double points = static_cast<double>(problem.reference_pixels.size());
  const int needed = std::max(config.min_points, static_cast<int>(config.min_visible * points));
  Eigen::Vector3d guess = Eigen::Vector3d::Zero();
  for (std::size_t v = 0; v < problem.views.size(); ++v) {
    const PixelMatches matches = matchesWithReference(problem, v);
    geometry[v].tracked = static_cast<int>(matches.size());
    geometry[v].usable = geometry[v].tracked >= needed;
    if (!geometry[v].usable) continue;
    geometry[v].rotation = fitRotation(problem.camera, matches, guess);
    guess = geometry[v].rotation.rotation;
  }
  return geometry;
}

ViewSplit splitViews(const StructureProblem& problem, const std::vector<ViewGeometry>& geometry,
                     const StructureConfig& config) {
  ViewSplit split;
  std::vector<std::size_t> usable;
  double widest = -1.0;
  for (std::size_t v = 0; v < geometry.size(); ++v) {
    if (!geometry[v].usable) continue;
    usable.push_back(v);
    const double score = geometry[v].rotation.median_residual * std::sqrt(static_cast<double>(geometry[v].tracked));
    if (score > widest) {
      widest = score;
      split.widest = v;
    }
  }
  const std::size_t bins = std::min(config.max_bundle_views, (6 * usable.size()) / 10);
  std::vector<char> chosen(geometry.size(), 0);
  for (std::size_t b = 0; b < bins; ++b) {
    const std::size_t begin = b * usable.size() / bins;
    const std::size_t end = (b + 1) * usable.size() / bins;
    std::size_t best = usable[begin];
    for (std::size_t i = begin; i < end; ++i) {
      if (usable[i] == split.widest) {
        best = usable[i];
        break;
      }
      if (problem.views[usable[i]].log_sharpness > problem.views[best].log_sharpness) best = usable[i];
    }
    chosen[best] = 1;
  }
  for (const std::size_t v : usable) (chosen[v] ? split.bundle : split.held_out).push_back(v);
  return split;
}

}  // namespace mba_vo
