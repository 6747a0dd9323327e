#pragma once

#include <vector>

#include "mba_vo/tracking/reference.h"

namespace mba_vo {

/// Indices of at most about `max_points` points of the reference for alignment on `level`, spread evenly: the point
/// with the highest gradient on that level in each cell of a grid. Where only a part of the image has points, the grid
/// is finer, but no finer than the patches need.
std::vector<int> selectEvenSubset(const Reference& reference, int level, int patch_side, int max_points);

}  // namespace mba_vo
