#pragma once

#include <cstddef>
#include <vector>

#include <opencv2/core.hpp>

#include "mba_vo/geometry/pinhole_camera.h"

namespace mba_vo {

/// One level: linear intensity [grey levels, 0..255 for the camera, then times the gain], NaN where the pixel is
/// invalid (outside a rectified image, masked). NaN spreads through every sum it enters, so a residual that touches an
/// invalid pixel is recognised by itself.
struct ImageLevel {
  cv::Mat1f intensity;
  PinholeCamera camera;
  double gain = 1.0;  // digital
};

/// Image pyramid, level 0 finest; each level averages 2x2 pixels of the one below it.
class ImagePyramid {
 public:
  ImagePyramid() = default;
  /// `intensity`: continuous CV_32FC1 of the camera's size. Throws std::invalid_argument if sizes disagree or levels
  /// < 1. Stops before a level would be narrower or lower than 16 px.
  ImagePyramid(const cv::Mat1f& intensity, const PinholeCamera& camera, int levels, double gain = 1.0);

  int levels() const { return static_cast<int>(levels_.size()); }
  const ImageLevel& level(int l) const { return levels_[static_cast<std::size_t>(l)]; }
  std::size_t bytes() const;
  /// To the camera's, of the finest level [s].
  void addRowTime(double row_time);

 private:
  std::vector<ImageLevel> levels_;
};

}  // namespace mba_vo
