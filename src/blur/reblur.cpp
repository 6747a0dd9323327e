#include "mba_vo/blur/reblur.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "mba_vo/blur/texel_corners.h"
#include "mba_vo/image/multiversion.h"

namespace mba_vo {
namespace {

constexpr int kLanes = 8;        // all pixels of a sparse pattern, or most of a row of nine
constexpr int kNarrowLanes = 4;  // of a row of five or seven
using Floats = float __attribute__((vector_size(kLanes * sizeof(float))));
using Ints = int __attribute__((vector_size(kLanes * sizeof(int))));

constexpr float kMargin = 0.01F;  // [px] floats of images of 16,000 pixels a side are exact to a tenth of it
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

struct Offsets {
  alignas(64) float dx[kMaxPatchPixels];
  alignas(64) float dy[kMaxPatchPixels];
};

/// Position of the patch at each moment u: x = cx + a00 dx + a01 dy, y = cy + a10 dx + a11 dy.
struct Placements {
  using Row = float[kMaxSamples];
  Row cx, cy, a00, a01, a10, a11, u;
};

[[gnu::always_inline]] inline void place(const PatchPath& path, int samples, Placements& __restrict out) {
  const float width = 1.0F / static_cast<float>(samples);
  const Eigen::Vector2f &c0 = path.c0, &c1 = path.c1, &c2 = path.c2;
  const Eigen::Matrix2f &A0 = path.A0, &A1 = path.A1;
  for (int i = 0; i < samples; ++i) {
    const float u = (static_cast<float>(i) + 0.5F) * width - 0.5F;
    out.u[i] = u;
    out.cx[i] = c0.x() + u * (c1.x() + u * c2.x());
    out.cy[i] = c0.y() + u * (c1.y() + u * c2.y());
    out.a00[i] = A0(0, 0) + u * A1(0, 0);
    out.a01[i] = A0(0, 1) + u * A1(0, 1);
    out.a10[i] = A0(1, 0) + u * A1(1, 0);
    out.a11[i] = A0(1, 1) + u * A1(1, 1);
  }
}

struct ImageView {
  const float* data;
  int stride;
  float max_x;  // largest coordinates that can be sampled
  float max_y;

  /// The square of `radius`, all along its path, whatever is rounded: |u| is at most a half.
  bool holds(const PatchPath& path, float radius) const {
    const Eigen::Matrix2f spread = path.A0.cwiseAbs() + 0.5F * path.A1.cwiseAbs();
    const Eigen::Vector2f reach =
        radius * spread.rowwise().sum() + 0.5F * path.c1.cwiseAbs() + 0.25F * path.c2.cwiseAbs();
    const Eigen::Vector2f low = path.c0 - reach;
    const Eigen::Vector2f high = path.c0 + reach;
    return low.minCoeff() >= kMargin && high.x() <= max_x - kMargin && high.y() <= max_y - kMargin;
  }
};

/// The pixels to the right of and below a sample are read too, so the last row and column cannot be its corner.
ImageView viewOf(const ImageLevel& level) {
  return {level.intensity[0], static_cast<int>(level.intensity.step1()),
          static_cast<float>(level.intensity.cols) - 1.001F, static_cast<float>(level.intensity.rows) - 1.001F};
}

// By reference: how such values are handed over differs between instruction sets.
[[gnu::always_inline]] inline void load(const float* from, Floats& lanes) { std::memcpy(&lanes, from, sizeof(lanes)); }

[[gnu::always_inline]] inline void clamp(const Floats& value, float most, Floats& clamped) {
  const Floats low = value > 0.0F ? value : Floats{};
  clamped = low < most ? low : Floats{} + most;
}

/// Means over all samples of the pixels `first` and following. `Inside`: none of them leaves the image. Inlined into
/// each of the versions below.
template <GradientMoments Wanted, bool Inside>
[[gnu::always_inline]] inline void averageLanes(const ImageView& image, const Placements& at, int samples,
                                                const Offsets& offsets, int first, ReblurredPatch& __restrict out) {
  Floats dx, dy;
  load(offsets.dx + first, dx);
  load(offsets.dy + first, dy);
  Floats value{}, sum_gx{}, sum_gy{}, sum_ugx{}, sum_ugy{}, sum_uugx{}, sum_uugy{}, outside{};
  for (int i = 0; i < samples; ++i) {
    const float u = at.u[i];
    const Floats x = at.cx[i] + at.a00[i] * dx + at.a01[i] * dy;
    const Floats y = at.cy[i] + at.a10[i] * dx + at.a11[i] * dy;
    Floats x_in = x;
    Floats y_in = y;
    if constexpr (!Inside) {
      clamp(x, image.max_x, x_in);
      clamp(y, image.max_y, y_in);
      outside += (x - x_in) * (x - x_in) + (y - y_in) * (y - y_in);
    }
    const Ints ix = __builtin_convertvector(x_in, Ints);
    const Ints iy = __builtin_convertvector(y_in, Ints);
    const Floats fx = x_in - __builtin_convertvector(ix, Floats);
    const Floats fy = y_in - __builtin_convertvector(iy, Floats);
    const Ints index_lanes = iy * image.stride + ix;
    int index[kLanes];
    std::memcpy(index, &index_lanes, sizeof(index));
    float corners[4][kLanes];
    readCorners<kLanes>(image.data, image.stride, index, corners[0], corners[1], corners[2], corners[3]);
    Floats i00, i10, i01, i11;
    load(corners[0], i00);
    load(corners[1], i10);
    load(corners[2], i01);
    load(corners[3], i11);
    const Floats upper = i10 - i00;
    const Floats lower = i11 - i01;
    const Floats top = i00 + fx * upper;
    const Floats gx = upper + fy * (lower - upper);
    const Floats gy = i01 + fx * lower - top;
    value += top + fy * gy;
    if constexpr (Wanted >= GradientMoments::kFirst) {
      sum_gx += gx;
      sum_gy += gy;
      sum_ugx += u * gx;
      sum_ugy += u * gy;
    }
    if constexpr (Wanted >= GradientMoments::kSecond) {
      sum_uugx += u * u * gx;
      sum_uugy += u * u * gy;
    }
  }
  const float scale = 1.0F / static_cast<float>(samples);
  const auto write = [&](const Floats& sum, std::array<float, kMaxPatchPixels>& mean) {
    const Floats scaled = scale * sum;
    std::memcpy(mean.data() + first, &scaled, sizeof(scaled));
  };
  write(outside > 0.0F ? Floats{} + kNaN : value, out.value);
  if constexpr (Wanted >= GradientMoments::kFirst) {
    write(sum_gx, out.gx);
    write(sum_gy, out.gy);
    write(sum_ugx, out.ugx);
    write(sum_ugy, out.ugy);
  }
  if constexpr (Wanted >= GradientMoments::kSecond) {
    write(sum_uugx, out.uugx);
    write(sum_uugy, out.uugy);
  }
}

/// `inside`: see averageLanes.
template <GradientMoments Wanted>
[[gnu::always_inline]] inline void average(const ImageView& image, const PatchPath& path, int samples,
                                           const Offsets& offsets, int count, bool inside,
                                           ReblurredPatch& __restrict out) {
  Placements at;
  place(path, samples, at);
  if (inside) {
    for (int k = 0; k < count; k += kLanes) averageLanes<Wanted, true>(image, at, samples, offsets, k, out);
  } else {
    for (int k = 0; k < count; k += kLanes) averageLanes<Wanted, false>(image, at, samples, offsets, k, out);
  }
}

MBA_VO_MULTIVERSION
void averageValues(const ImageView& image, const PatchPath& path, int samples, const Offsets& offsets, int count,
                   bool inside, ReblurredPatch& __restrict out) {
  average<GradientMoments::kOmitted>(image, path, samples, offsets, count, inside, out);
}

MBA_VO_MULTIVERSION
void averageFirstMoments(const ImageView& image, const PatchPath& path, int samples, const Offsets& offsets, int count,
                         bool inside, ReblurredPatch& __restrict out) {
  average<GradientMoments::kFirst>(image, path, samples, offsets, count, inside, out);
}

MBA_VO_MULTIVERSION
void averageSecondMoments(const ImageView& image, const PatchPath& path, int samples, const Offsets& offsets, int count,
                          bool inside, ReblurredPatch& __restrict out) {
  average<GradientMoments::kSecond>(image, path, samples, offsets, count, inside, out);
}

/// A sample of the whole patch: its upper left pixel, and the weights of the four corners, which all pixels share.
struct Shift {
  const float* corner;
  float w00, w10, w01, w11;
};

/// Sums of the `side` pixels of each row. Two blocks of lanes, the second ending where the row does: nothing beyond the
/// patch is read.
template <int Lanes>
[[gnu::always_inline]] inline void sumRows(const Shift* shifts, int samples, int stride, int side,
                                           float* __restrict sums) {
  const int second = side - Lanes;
  for (int row = 0; row < side; ++row) {
    alignas(64) float left[Lanes] = {};
    alignas(64) float right[Lanes] = {};
    const std::ptrdiff_t below = static_cast<std::ptrdiff_t>(row) * stride;
    for (int i = 0; i < samples; ++i) {
      const Shift& s = shifts[i];
      const float* __restrict upper = s.corner + below;
      const float* __restrict lower = upper + stride;
      for (int k = 0; k < Lanes; ++k) {
        left[k] += s.w00 * upper[k] + s.w10 * upper[k + 1] + s.w01 * lower[k] + s.w11 * lower[k + 1];
      }
      for (int k = 0; k < Lanes; ++k) {
        const int x = second + k;
        right[k] += s.w00 * upper[x] + s.w10 * upper[x + 1] + s.w01 * lower[x] + s.w11 * lower[x + 1];
      }
    }
    std::copy(left, left + Lanes, sums + side * row);
    std::copy(right, right + Lanes, sums + side * row + second);
  }
}

MBA_VO_MULTIVERSION
void sumWideRows(const Shift* shifts, int samples, int stride, int side, float* __restrict sums) {
  sumRows<kLanes>(shifts, samples, stride, side, sums);
}

MBA_VO_MULTIVERSION
void sumNarrowRows(const Shift* shifts, int samples, int stride, int side, float* __restrict sums) {
  sumRows<kNarrowLanes>(shifts, samples, stride, side, sums);
}

int roundUp(int n) { return (n + kLanes - 1) / kLanes * kLanes; }

Shift shiftTo(const ImageView& image, const Eigen::Vector2f& upper_left) {
  const int x = static_cast<int>(upper_left.x());
  const int y = static_cast<int>(upper_left.y());
  const float fx = upper_left.x() - static_cast<float>(x);
  const float fy = upper_left.y() - static_cast<float>(y);
  return {image.data + static_cast<std::ptrdiff_t>(y) * image.stride + x, (1.0F - fx) * (1.0F - fy), fx * (1.0F - fy),
          (1.0F - fx) * fy, fx * fy};
}

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

void reblurPatch(const ImageLevel& reference, const PatchPath& path, const PatchPattern& pattern, int samples,
                 ReblurredPatch& out, GradientMoments wanted) {
  const int count = roundUp(pattern.size);
  const Offsets offsets = makeOffsets(pattern, count);
  const ImageView image = viewOf(reference);
  const int n = std::clamp(samples, 1, kMaxSamples);
  const bool inside = image.holds(path, static_cast<float>(pattern.radius));
  switch (wanted) {
    case GradientMoments::kOmitted:
      return averageValues(image, path, n, offsets, count, inside, out);
    case GradientMoments::kFirst:
      return averageFirstMoments(image, path, n, offsets, count, inside, out);
    case GradientMoments::kSecond:
      return averageSecondMoments(image, path, n, offsets, count, inside, out);
  }
}

void reblurParallel(const ImageLevel& level, const PatchPath& path, const PatchPattern& pattern, int samples,
                    std::array<float, kMaxPatchPixels>& value) {
  const ImageView image = viewOf(level);
  const int n = std::clamp(samples, 1, kMaxSamples);
  const int side = 2 * pattern.radius + 1;
  if (side < kNarrowLanes || !image.holds(path, static_cast<float>(pattern.radius))) {  // some pixels may be valid
    ReblurredPatch patch;
    reblurPatch(level, path, pattern, samples, patch, GradientMoments::kOmitted);
    value = patch.value;
    return;
  }
  const auto radius = static_cast<float>(pattern.radius);
  std::array<Shift, kMaxSamples> shifts;
  for (int i = 0; i < n; ++i) {
    const float u = (static_cast<float>(i) + 0.5F) / static_cast<float>(n) - 0.5F;
    const Eigen::Vector2f centre = path.c0 + u * (path.c1 + u * path.c2);
    shifts[static_cast<std::size_t>(i)] = shiftTo(image, centre.array() - radius);
  }
  std::array<float, kMaxPatchPixels> sums;
  const auto sum = side > kLanes ? sumWideRows : sumNarrowRows;
  sum(shifts.data(), n, image.stride, side, sums.data());
  for (std::size_t k = 0; k < static_cast<std::size_t>(pattern.size); ++k) {
    const int place = side * (pattern.dy[k] + pattern.radius) + pattern.dx[k] + pattern.radius;
    value[k] = sums[static_cast<std::size_t>(place)] / static_cast<float>(n);
  }
}

}  // namespace mba_vo
