#include "mba_vo/depth_search/patch_match.h"

#include <cmath>

#include "mba_vo/blur/texel_corners.h"
#include "mba_vo/image/multiversion.h"

namespace mba_vo {
namespace {

constexpr int kLanes = static_cast<int>(SearchPatch::kSize);

/// Bilinear interpolation at all pixels of a patch, and its derivative.
struct Samples {
  alignas(32) float value[kLanes];
  alignas(32) float gx[kLanes];
  alignas(32) float gy[kLanes];
};

[[gnu::always_inline]] inline void sampleAll(const float* __restrict data, int stride, const SearchPatch& patch,
                                             float cx, float cy, Samples& __restrict out) {
  alignas(32) int index[kLanes];
  alignas(32) float wx[kLanes], wy[kLanes];
  for (std::size_t k = 0; k < kLanes; ++k) {
    const float x = cx + patch.dx[k];
    const float y = cy + patch.dy[k];
    const int ix = static_cast<int>(x);
    const int iy = static_cast<int>(y);
    wx[k] = x - static_cast<float>(ix);
    wy[k] = y - static_cast<float>(iy);
    index[k] = iy * stride + ix;
  }
  alignas(32) float i00[kLanes], i10[kLanes], i01[kLanes], i11[kLanes];
  readCorners<kLanes>(data, stride, index, i00, i10, i01, i11);
  for (int k = 0; k < kLanes; ++k) {
    const float upper = i10[k] - i00[k];
    const float lower = i11[k] - i01[k];
    const float top = i00[k] + wx[k] * upper;
    const float gy = i01[k] + wx[k] * lower - top;
    out.value[k] = top + wy[k] * gy;
    out.gx[k] = upper + wy[k] * (lower - upper);
    out.gy[k] = gy;
  }
}

[[gnu::always_inline]] inline float sum(const float* v) {
  return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}

MBA_VO_MULTIVERSION
float energyOf(const float* data, int stride, const SearchPatch& patch, float cx, float cy, float threshold) {
  Samples samples;
  sampleAll(data, stride, patch, cx, cy, samples);
  alignas(32) float energy[kLanes];
  for (std::size_t k = 0; k < kLanes; ++k) {
    const float r = std::abs(samples.value[k] - patch.value[k]);
    const float inside = r < threshold ? r : threshold;
    energy[k] = inside * (2.0F * r - inside);
  }
  return sum(energy);
}

MBA_VO_MULTIVERSION
void sumStep(const float* data, int stride, const SearchPatch& patch, float cx, float cy, float dx, float dy,
             float threshold, float* __restrict sums) {
  Samples samples;
  sampleAll(data, stride, patch, cx, cy, samples);
  alignas(32) float hessian[kLanes], gradient[kLanes], squared[kLanes], mixed[kLanes];
  for (std::size_t k = 0; k < kLanes; ++k) {
    const float residual = samples.value[k] - patch.value[k];
    const float magnitude = std::abs(residual);
    const float quotient = threshold / magnitude;
    const float weight = magnitude <= threshold ? 1.0F : quotient;
    const float along = samples.gx[k] * dx + samples.gy[k] * dy;
    const float across = samples.gy[k] * dx - samples.gx[k] * dy;
    hessian[k] = weight * along * along;
    gradient[k] = weight * along * residual;
    squared[k] = along * along;
    mixed[k] = along * across;
  }
  sums[0] = sum(hessian);
  sums[1] = sum(gradient);
  sums[2] = sum(squared);
  sums[3] = sum(mixed);
}

}  // namespace

float patchEnergy(const cv::Mat1f& image, const SearchPatch& patch, const Eigen::Vector2d& centre, float threshold) {
  const Eigen::Vector2f c = centre.cast<float>();
  return energyOf(image[0], static_cast<int>(image.step1()), patch, c.x(), c.y(), threshold);
}

LineStep linearise(const cv::Mat1f& image, const SearchPatch& patch, const Eigen::Vector2d& centre,
                   const Eigen::Vector2d& direction, double threshold) {
  const Eigen::Vector2f c = centre.cast<float>();
  const Eigen::Vector2f d = direction.cast<float>();
  float sums[4];
  sumStep(image[0], static_cast<int>(image.step1()), patch, c.x(), c.y(), d.x(), d.y(), static_cast<float>(threshold),
          sums);
  return {static_cast<double>(sums[0]), static_cast<double>(sums[1]), static_cast<double>(sums[2]),
          static_cast<double>(sums[3])};
}

double matchError(const LineStep& step, double line_error_px) {
  return line_error_px * (1.0 + std::abs(step.mixed) / step.along) + kMatchNoise / std::sqrt(step.along);
}

}  // namespace mba_vo
