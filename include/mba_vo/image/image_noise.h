#pragma once

#include <opencv2/core.hpp>

namespace mba_vo {

/// Standard deviation of an image's noise [grey levels], from what smooth surfaces and straight edges cannot cause: the
/// median of |second difference in x of the second difference in y|. Never below that of rounding to grey levels.
float estimateNoise(const cv::Mat1f& image);

}  // namespace mba_vo
