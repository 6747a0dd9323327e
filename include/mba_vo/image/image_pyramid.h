#pragma once

#include <cstddef>
#include <vector>

#include <opencv2/core.hpp>

#include "mba_vo/geometry/calibration_correction.h"

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
  /// The camera of the image is known better: it takes over what a pinhole camera can have of what was lacking.
  void correctCamera(const CalibrationCorrection& lacking);
  /// Whether both have the same pixels, whatever is known of the camera.
  bool showsTheSameAs(const ImagePyramid& other) const {
    return level(0).intensity.data == other.level(0).intensity.data;
  }

 private:
  std::vector<ImageLevel> levels_;
};

}  // namespace mba_vo
