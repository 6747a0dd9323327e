#pragma once

#include <opencv2/core.hpp>

namespace mba_vo {

/// Units per metre of 16-bit depth images: of the TUM RGB-D sequences, and of REP-118 (millimetres).
inline constexpr double kTumDepthUnits = 5000.0;
inline constexpr double kMillimetres = 1000.0;

/// Depths along the optical axis [m], NaN = unknown, from a depth image: 16 bit, one channel, in `units_per_metre`, or
/// 32-bit float in metres. Zero, negative and infinite depths are unknown. Throws std::invalid_argument naming any
/// other type and what is allowed.
cv::Mat1f depthInMetres(const cv::Mat& image, double units_per_metre);

}  // namespace mba_vo
