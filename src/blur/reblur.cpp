#include "mba_vo/blur/reblur.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "mba_vo/blur/multiversion.h"
#include "mba_vo/blur/texel_corners.h"

namespace mba_vo {
namespace {

constexpr int kLanes = 16;
constexpr int kFewLanes = 8;  // for the sparse patterns of the window and the depth search
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

struct Offsets {
  alignas(64) float dx[kMaxPatchPixels];
  alignas(64) float dy[kMaxPatchPixels];
};

/// Position of the patch at one moment: x = cx + a00 dx + a01 dy, y = cy + a10 dx + a11 dy.
struct Placement {
  float cx, cy, a00, a01, a10, a11, u;
};

Placement placementAt(const PatchPath& path, float u) {
  const Eigen::Vector2f c = path.c0 + u * (path.c1 + u * path.c2);
  const Eigen::Matrix2f A = path.A0 + u * path.A1;
  return {c.x(), c.y(), A(0, 0), A(0, 1), A(1, 0), A(1, 1), u};
}

struct ImageView {
  const float* data;
  int stride;
  float max_x;  // largest coordinates that can be sampled
  float max_y;
};

/// Means over all samples of the `Lanes` pixels whose offsets begin at dx, dy. Inlined into each of the versions below.
template <int Lanes>
[[gnu::always_inline]] inline void averageLanes(const ImageView& image, const Placement* placements, int samples,
                                                const Offsets& offsets, int first, ReblurredPatch& __restrict out) {
  const float* __restrict dx = offsets.dx + first;
  const float* __restrict dy = offsets.dy + first;
  // One array each, not a struct of them: so they stay in registers.
  alignas(64) float value[Lanes] = {};
  alignas(64) float sum_gx[Lanes] = {};
  alignas(64) float sum_gy[Lanes] = {};
  alignas(64) float sum_ugx[Lanes] = {};
  alignas(64) float sum_ugy[Lanes] = {};
  alignas(64) float sum_uugx[Lanes] = {};
  alignas(64) float sum_uugy[Lanes] = {};
  alignas(64) float outside[Lanes] = {};
  const float* __restrict data = image.data;
  for (int i = 0; i < samples; ++i) {
    const Placement at = placements[i];
    const float u = at.u;
    const float uu = u * u;
    alignas(64) int index[Lanes];
    alignas(64) float fx[Lanes], fy[Lanes];
    for (int k = 0; k < Lanes; ++k) {
      const float x = at.cx + at.a00 * dx[k] + at.a01 * dy[k];
      const float y = at.cy + at.a10 * dx[k] + at.a11 * dy[k];
      const float x_low = x > 0.0F ? x : 0.0F;
      const float y_low = y > 0.0F ? y : 0.0F;
      const float x_in = x_low < image.max_x ? x_low : image.max_x;
      const float y_in = y_low < image.max_y ? y_low : image.max_y;
      outside[k] += std::abs(x - x_in) + std::abs(y - y_in);
      const int ix = static_cast<int>(x_in);
      const int iy = static_cast<int>(y_in);
      fx[k] = x_in - static_cast<float>(ix);
      fy[k] = y_in - static_cast<float>(iy);
      index[k] = iy * image.stride + ix;
    }
    alignas(64) float i00[Lanes], i10[Lanes], i01[Lanes], i11[Lanes];
    readCorners<Lanes>(data, image.stride, index, i00, i10, i01, i11);
    for (int k = 0; k < Lanes; ++k) {
      const float upper = i10[k] - i00[k];
      const float lower = i11[k] - i01[k];
      const float top = i00[k] + fx[k] * upper;
      const float gx = upper + fy[k] * (lower - upper);
      const float gy = i01[k] + fx[k] * lower - top;
      value[k] += top + fy[k] * gy;
      sum_gx[k] += gx;
      sum_gy[k] += gy;
      sum_ugx[k] += u * gx;
      sum_ugy[k] += u * gy;
      sum_uugx[k] += uu * gx;
      sum_uugy[k] += uu * gy;
    }
  }
  const float scale = 1.0F / static_cast<float>(samples);
  const auto write = [&](const float* sum, std::array<float, kMaxPatchPixels>& mean) {
    for (int k = 0; k < Lanes; ++k) mean[static_cast<std::size_t>(first + k)] = scale * sum[k];
  };
  for (int k = 0; k < Lanes; ++k) {
    const float mean = scale * value[k];
    out.value[static_cast<std::size_t>(first + k)] = outside[k] > 0.0F ? kNaN : mean;
  }
  write(sum_gx, out.gx);
  write(sum_gy, out.gy);
  write(sum_ugx, out.ugx);
  write(sum_ugy, out.ugy);
  write(sum_uugx, out.uugx);
  write(sum_uugy, out.uugy);
}

MBA_VO_MULTIVERSION
void averageBlocks(const ImageView& image, const Placement* placements, int samples, const Offsets& offsets, int count,
                   ReblurredPatch& __restrict out) {
  for (int first = 0; first < count; first += kLanes) {
    averageLanes<kLanes>(image, placements, samples, offsets, first, out);
  }
}

MBA_VO_MULTIVERSION
void averageFew(const ImageView& image, const Placement* placements, int samples, const Offsets& offsets,
                ReblurredPatch& __restrict out) {
  averageLanes<kFewLanes>(image, placements, samples, offsets, 0, out);
}

int roundUp(int n) { return (n + kLanes - 1) / kLanes * kLanes; }

Offsets makeOffsets(const PatchPattern& pattern, int count) {
  Offsets offsets;
  for (int k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    offsets.dx[k] = static_cast<float>(pattern.dx[i]);  // 0 beyond the pattern's size
    offsets.dy[k] = static_cast<float>(pattern.dy[i]);
  }
  return offsets;
}

}  // namespace

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

void reblurPatch(const ImageLevel& reference, const PatchPath& path, const PatchPattern& pattern, int samples,
                 ReblurredPatch& out) {
  const int count = pattern.size <= kFewLanes ? kFewLanes : roundUp(pattern.size);
  const Offsets offsets = makeOffsets(pattern, count);
  const int n = std::clamp(samples, 1, kMaxSamples);
  std::array<Placement, kMaxSamples> placements;
  for (int i = 0; i < n; ++i) {
    const float u = (static_cast<float>(i) + 0.5F) / static_cast<float>(n) - 0.5F;
    placements[static_cast<std::size_t>(i)] = placementAt(path, u);
  }
  // The pixels to the right of and below a sample are read too, so the last row and column cannot be its corner.
  const ImageView image{reference.intensity[0], static_cast<int>(reference.intensity.step1()),
                        static_cast<float>(reference.intensity.cols) - 1.001F,
                        static_cast<float>(reference.intensity.rows) - 1.001F};
  if (pattern.size <= kFewLanes) {
    averageFew(image, placements.data(), n, offsets, out);
  } else {
    averageBlocks(image, placements.data(), n, offsets, count, out);
  }
}

}  // namespace mba_vo
