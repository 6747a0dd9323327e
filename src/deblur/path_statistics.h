#pragma once

#include "mba_vo/deblur/deblurrer.h"

namespace mba_vo {

/// The keyframe's paths, all over the image.
struct PathStatistics {
  float median = 0.0F;        // length [px]
  float disagreement = 0.0F;  // median distance between the ends by one and the other velocity, twice [px]
  float reach = 0.0F;         // furthest from the pixel [px]
};

/// `depth`: of every pixel [1/m].
PathStatistics measurePaths(const DeblurInput& input, const cv::Mat1f& depth);

/// Median length of the paths [px], by the depths that are known; 0 if none are.
float medianBlur(const DeblurInput& input);

}  // namespace mba_vo
