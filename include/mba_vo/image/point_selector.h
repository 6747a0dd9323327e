#pragma once

#include <vector>

#include <Eigen/Core>

#include "mba_vo/image/image_pyramid.h"

namespace mba_vo {

/// Pixels of the finest level with a high gradient compared with their surroundings, spread evenly: the image is cut in
/// cells whose size is adapted until about `count` cells deliver a point; a cell's best pixel must exceed the
/// gradient threshold of its region (median + `gradient_margin`, smoothed over neighbouring regions).
struct PointSelectorConfig {
  double gradient_margin = 7.0;  // [grey levels / px]
  int border = 8;                // [px]
};

std::vector<Eigen::Vector2i> selectPoints(const ImagePyramid& pyramid, int count, const PointSelectorConfig& config);

}  // namespace mba_vo
