#pragma once

#include <optional>

#include "mba_vo/tracking/alignment_problem.h"
#include "mba_vo/tracking/tracked_frame.h"

namespace mba_vo {

/// What the image says of an exposure that was taken for `expected` [s], without what was expected: the logarithm that
/// was found, `state` being the minimum, lies between both; the more of it is the image's, the nearer to that. nullopt
/// if it was not estimated, or the image tells nothing.
std::optional<ExposureSample> exposureByRows(double expected, const AlignmentState& state,
                                             const AlignmentProblem::Equations& equations);

}  // namespace mba_vo
