#pragma once

#include <cstddef>
#include <vector>

#include "mba_vo/initialization/initializer_structure.h"
#include "mba_vo/initialization/two_view_geometry.h"

namespace mba_vo {

/// What is known of a view before there is structure.
struct ViewGeometry {
  bool usable = false;  // enough of the reference is tracked
  int tracked = 0;
  RotationFit rotation;
};

PixelMatches matchesWithReference(const StructureProblem& problem, std::size_t view);

std::vector<ViewGeometry> analyseViews(const StructureProblem& problem, const StructureConfig& config);

/// Which views build the structure and which validate it.
struct ViewSplit {
  std::size_t widest = 0;             // most flow that rotation does not explain
  std::vector<std::size_t> bundle;    // by time, contains `widest`
  std::vector<std::size_t> held_out;  // all other usable ones
};

/// The usable views are cut into stretches of time, of which each gives its sharpest. At most 60 % of them build the
/// structure, so that some are left to test it.
ViewSplit splitViews(const StructureProblem& problem, const std::vector<ViewGeometry>& geometry,
                     const StructureConfig& config);

}  // namespace mba_vo
