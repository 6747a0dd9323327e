#include "mba_vo/blur/patch_pattern.h"

#include <cstddef>
#include <stdexcept>
#include <string>

namespace mba_vo {

PatchPattern PatchPattern::square(int side) {
  if (side < 1 || side > 9 || side % 2 == 0) {
    throw std::invalid_argument("patch pattern: side is " + std::to_string(side) + ", must be odd and at most 9");
  }
  PatchPattern pattern;
  pattern.radius = side / 2;
  for (int y = -pattern.radius; y <= pattern.radius; ++y) {
    for (int x = -pattern.radius; x <= pattern.radius; ++x) {
      pattern.dx[static_cast<std::size_t>(pattern.size)] = x;
      pattern.dy[static_cast<std::size_t>(pattern.size)] = y;
      ++pattern.size;
    }
  }
  return pattern;
}

PatchPattern PatchPattern::spread8() {
  constexpr int kOffsets[8][2] = {{0, 0}, {-2, 0}, {2, 0}, {0, -2}, {0, 2}, {-1, -1}, {1, -1}, {-1, 1}};
  PatchPattern pattern;
  pattern.radius = 2;
  for (const auto& offset : kOffsets) {
    pattern.dx[static_cast<std::size_t>(pattern.size)] = offset[0];
    pattern.dy[static_cast<std::size_t>(pattern.size)] = offset[1];
    ++pattern.size;
  }
  return pattern;
}

}  // namespace mba_vo
