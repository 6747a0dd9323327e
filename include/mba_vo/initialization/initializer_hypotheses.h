#pragma once

#include <optional>

#include "mba_vo/initialization/initializer_views.h"

namespace mba_vo {

/// One local minimum of the bundle adjustment.
struct Hypothesis {
  Bundle bundle;  // over the views of ViewSplit::bundle, scale normalised
  double cost = 0.0;
  double runner_up_ratio = 1e9;  // cost of the best solution that differs, over this one's
};

/// Observations of a view; pose: rotation only.
BundleView makeBundleView(const StructureProblem& problem, const std::vector<ViewGeometry>& geometry, std::size_t view);

/// The same with the translation of the view in `bundle` that is nearest in time.
BundleView nearestStart(const StructureProblem& problem, const std::vector<ViewGeometry>& geometry,
                        const ViewSplit& split, const Bundle& bundle, std::size_t view);

/// Best of all solutions found from different starts; nothing if no start can be made.
std::optional<Hypothesis> bestHypothesis(const StructureProblem& problem, const std::vector<ViewGeometry>& geometry,
                                         const ViewSplit& split);

}  // namespace mba_vo
