#pragma once

#include <array>

namespace mba_vo {

/// Most pixels that a patch can have (9x9 = 81, padded to a multiple of 16).
inline constexpr int kMaxPatchPixels = 96;

/// Pixel offsets of a patch in the blurred image, relative to its integer centre.
struct PatchPattern {
  int size = 0;
  std::array<int, kMaxPatchPixels> dx{};
  std::array<int, kMaxPatchPixels> dy{};
  int radius = 0;  // largest |offset|

  static PatchPattern square(int side);  // side odd, at most 9
  static PatchPattern spread8();         // the sparse 8-pixel pattern of DSO (paper, Fig. 4)
};

}  // namespace mba_vo
