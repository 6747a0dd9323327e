#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "mba_vo/image/image_pyramid.h"
#include "mba_vo/image/point_selector.h"

namespace mba_vo {

/// Length of the gradient by central differences [grey levels / px], 0 in the outermost pixels.
cv::Mat1f gradientMagnitude(const cv::Mat1f& image);

/// A pixel whose gradient exceeds the threshold of its region.
struct GradientCandidate {
  int x, y;  // at level 0 [px]; for coarser levels the upper left pixel of the block that the pixel averages
  float gx, gy;
};

/// 255 where a pixel may be chosen: at least `border` from the edge of the image and from every NaN.
cv::Mat1b makeAllowedMask(const cv::Mat1f& image, int border);

/// Median gradient of every 32x32 region of the finest level, smoothed over the 3x3 regions around it.
class RegionMedians {
 public:
  RegionMedians(const cv::Mat1f& magnitude, const cv::Mat1b& allowed);
  float at(int x, int y) const { return smoothed_(y / kSide, x / kSide); }
  const float* row(int y) const { return smoothed_[y / kSide]; }

  static constexpr int kSide = 32;  // [px]

 private:
  cv::Mat1f smoothed_;
};

/// Allowed pixels of `level`, of which `image` and `magnitude` are, whose gradient exceeds the median of its region
/// plus `margin`.
std::vector<GradientCandidate> findCandidates(const cv::Mat1f& image, const cv::Mat1f& magnitude, int level,
                                              const cv::Mat1b& allowed, const RegionMedians& medians, float margin);

}  // namespace mba_vo
