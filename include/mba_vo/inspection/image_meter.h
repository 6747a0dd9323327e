#pragma once

#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "mba_vo/inspection/camera_facts.h"

namespace mba_vo {

/// Grey image with 0 = black and 255 = white, of an 8-bit or 16-bit image (white at `white_level`) of 1, 3 (BGR) or 4
/// channels.
cv::Mat1f greyImage(const cv::Mat& image, double white_level);

/// `image`: as recorded; `grey`: its greyImage.
PixelFacts measurePixels(const cv::Mat& image, const cv::Mat1f& grey, double white_level);

/// Follows corners from image to image.
class MotionMeter {
 public:
  /// `grey`: by greyImage. Nullopt for the first image, one of another size, or where too few points are found again.
  std::optional<MotionFacts> add(const cv::Mat1f& grey);

 private:
  cv::Mat1b last_;
};

}  // namespace mba_vo
