#pragma once

#include <opencv2/core.hpp>

namespace mba_vo {

/// What a texture shows. Patterns repeat, pictures are shown once, with a frame around them.
enum class Pattern { kPlaster, kWood, kFabric, kBricks, kTiles, kStone, kCarpet, kPage, kBooks, kPanel, kPicture };
constexpr int kPatterns = 11;

/// Paints a pattern as a square image of reflectances in [0, 1]; `side` a power of two of at least 64.
/// The finest detail spans more than a texel.
cv::Mat1f paintPattern(Pattern pattern, int side, cv::RNG& random);

}  // namespace mba_vo
