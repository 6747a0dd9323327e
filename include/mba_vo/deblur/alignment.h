#pragma once

#include <opencv2/core.hpp>

namespace mba_vo {

/// By how much a predicted image is shifted against the observed one, block by block.
struct Alignment {
  static constexpr int kBlock = 32;  // [px]

  float shift_px = 0.0F;  // median over the blocks with enough structure to tell [px]
  int blocks = 0;         // with enough structure
  cv::Mat1b misaligned;   // per block, 255: shifted by more than the limit
};

/// One step of Lucas and Kanade per block, from `predicted` to `observed`, over the pixels with a positive weight.
/// A block tells if its shift is known to a quarter of a pixel, by its residuals and gradients. `limit_px`: shift
/// from which on a block counts as misaligned [px].
Alignment measureAlignment(const cv::Mat1f& predicted, const cv::Mat1f& observed, const cv::Mat1f& weight,
                           float limit_px);

}  // namespace mba_vo
