#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace mba_vo {

/// Periodic square texture with a mip-map, linear in reflectance.
class Texture {
 public:
  /// `image`: square, side a power of two, values in [0, 1].
  explicit Texture(const cv::Mat1f& image);

  /// Reflectance at (s, t) [texels of the finest level, centres at integers], filtered to texels of size 2^lod.
  float sample(float s, float t, float lod) const {
    if (lod <= 0.0F) return bilinear(0, s, t);
    const int level = static_cast<int>(lod);
    if (level >= last_level_) return bilinear(last_level_, s, t);
    const float weight = lod - static_cast<float>(level);
    return (1.0F - weight) * bilinear(level, s, t) + weight * bilinear(level + 1, s, t);
  }

 private:
  struct Level {
    std::size_t offset;
    int shift;    // log2(width)
    int mask;     // width - 1
    float scale;  // texels of this level per texel of the finest
    float bias;   // texel centres are at integers on every level
  };

  static int floorToInt(float x) {
    const int i = static_cast<int>(x);
    return i - (x < static_cast<float>(i) ? 1 : 0);
  }

  float bilinear(int index, float s, float t) const {
    const Level& level = levels_[static_cast<std::size_t>(index)];
    const float x = s * level.scale + level.bias;
    const float y = t * level.scale + level.bias;
    const int ix = floorToInt(x);
    const int iy = floorToInt(y);
    const float fx = x - static_cast<float>(ix);
    const float fy = y - static_cast<float>(iy);
    const int x0 = ix & level.mask;
    const int x1 = (ix + 1) & level.mask;
    const std::uint16_t* row0 = texels_.data() + level.offset + ((iy & level.mask) << level.shift);
    const std::uint16_t* row1 = texels_.data() + level.offset + (((iy + 1) & level.mask) << level.shift);
    const float top = static_cast<float>(row0[x0]) + fx * static_cast<float>(row0[x1] - row0[x0]);
    const float bottom = static_cast<float>(row1[x0]) + fx * static_cast<float>(row1[x1] - row1[x0]);
    return (top + fy * (bottom - top)) * (1.0F / 65535.0F);
  }

  int last_level_;
  std::vector<Level> levels_;
  std::vector<std::uint16_t> texels_;
};

}  // namespace mba_vo
