#pragma once

#include <opencv2/core.hpp>

namespace mba_vo {

/// 255 where a pixel tells only that it is bright: one of its colours, 8-bit or 16-bit and white at `white_level`, is
/// white or almost.
cv::Mat1b saturatedPixels(const cv::Mat& image, double white_level);

}  // namespace mba_vo
