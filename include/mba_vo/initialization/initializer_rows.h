#pragma once

#include <vector>

#include "mba_vo/initialization/initializer_bundle.h"
#include "mba_vo/initialization/initializer_structure.h"

namespace mba_vo {

/// The same tracks as a global shutter would have them: each is read off, at mid-exposure, the parabola through where
/// its point is seen in three images, at the times of its rows there. A track that fewer images have is left out.
StructureProblem withGlobalShutter(const StructureProblem& problem, double row_time);

/// Row time of a rolling shutter that nobody told.
struct RowTimeFit {
  double row_time = 0.0;    // [s]
  double cost_ratio = 1.0;  // of the bundle with it, over that with a global shutter
};

/// The row time with which the bundle of `views` fits best; `bundle` is its solution with a global shutter.
RowTimeFit fitRowTime(const StructureProblem& problem, const std::vector<std::size_t>& views, const Bundle& bundle);

}  // namespace mba_vo
