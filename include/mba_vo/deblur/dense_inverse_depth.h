#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "mba_vo/geometry/pinhole_camera.h"

namespace mba_vo {

/// A pixel of the keyframe with known depth.
struct DepthSample {
  Eigen::Vector2f pixel;  // [px]
  float inverse_depth;    // [1/m]
};

/// Inverse depth of every pixel [1/m] from those of a few, all positive. The nearest samples around a place are taken
/// for points of one plane, on which inverse depth is linear in the pixel; samples off it are on another surface and do
/// not count, so that edges of things stay edges. Made for cells of 8x8 pixels, interpolated between. Samples outside
/// the image count as well. Empty without any usable sample.
cv::Mat1f denseInverseDepth(const PinholeCamera& camera, const std::vector<DepthSample>& samples);

}  // namespace mba_vo
