#pragma once

#include <vector>

#include <Eigen/Core>

#include "mba_vo/image/image_pyramid.h"

namespace mba_vo {

/// Pixels of the finest level whose gradient stands out of the noise and of their surroundings, spread evenly: the
/// image is cut in cells whose size is adapted until about `count` cells deliver a point; a cell's best pixel must
/// exceed the gradient threshold of its region (median, smoothed over neighbouring regions, + `noise_margin` standard
/// deviations of the noise; docs/decisions/2026-11-28-faint-texture.md). Where 2x2 (or 4x4) cells in a row found
/// nothing, one point is taken there if the gradient of the next (or second next) coarser level, in which the noise is
/// halved (and halved again), does so: a bare wall or ceiling may be all that there is to see, and the points of its
/// edges alone would leave a pose free to slide. Which pixel of a cell is best is judged by the gradient along a
/// direction that changes from cell to cell, so that edges of all directions are represented. Pixels nearer than
/// `border` to the edge or to an invalid pixel are left out.
struct PointSelectorConfig {
  double noise_margin = 3.0;  // [standard deviations of the noise / px]
  int border = 8;             // [px]
};

/// Fewer than `count` points come back if the image does not have more. The same input gives the same points.
/// Throws std::invalid_argument for an empty pyramid or a negative count or border.
std::vector<Eigen::Vector2i> selectPoints(const ImagePyramid& pyramid, int count, const PointSelectorConfig& config);

}  // namespace mba_vo
