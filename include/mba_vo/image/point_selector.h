#pragma once

#include <vector>

#include <Eigen/Core>

#include "mba_vo/image/image_pyramid.h"

namespace mba_vo {

/// Pixels of the finest level with a high gradient compared with their surroundings, spread evenly: the image is cut in
/// cells whose size is adapted until about `count` cells deliver a point; a cell's best pixel must exceed the
/// gradient threshold of its region (median + `gradient_margin`, or more where noise would reach that, smoothed over
/// neighbouring regions).
/// Where 2x2 (or 4x4) cells in a row found nothing, one point is taken there if the gradient of the next (or second
/// next) coarser level exceeds a lowered threshold, so that smooth shading counts too; with `faint_texture` if it
/// stands out of the noise, which is halved (and halved again) there: a bare wall or ceiling may be all that there is
/// to see, and a pose slides along the points of its edges alone (docs/decisions/2026-11-28-faint-texture.md). Which
/// pixel of a cell is best is judged by the gradient along a direction that changes from cell to cell, so that edges of
/// all directions are represented. Pixels nearer than `border` to the edge or to an invalid pixel are left out.
struct PointSelectorConfig {
  double gradient_margin = 7.0;        // [grey levels / px]
  int border = 8;                      // [px]
  double coarse_margin_factor = 0.75;  // of gradient_margin, once per coarser level
  bool faint_texture = false;          // for a map that finds out what such points are worth
};

/// Fewer than `count` points come back if the image does not have more. The same input gives the same points.
/// Throws std::invalid_argument for an empty pyramid or a negative count or border.
std::vector<Eigen::Vector2i> selectPoints(const ImagePyramid& pyramid, int count, const PointSelectorConfig& config);

}  // namespace mba_vo
