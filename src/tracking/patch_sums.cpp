#include "mba_vo/tracking/patch_sums.h"

#include <algorithm>
#include <cmath>

#include "mba_vo/blur/multiversion.h"

namespace mba_vo {
namespace {

constexpr int kLanes = 16;

struct Weighted {
  alignas(64) float rows[kMoments + 1][kMaxPatchPixels];  // moments, then the residual; 0 where invalid
  alignas(64) float weight[kMaxPatchPixels];
  alignas(64) float cost[kMaxPatchPixels];
  alignas(64) float inlier[kMaxPatchPixels];  // 1 or 0
  alignas(64) float valid[kMaxPatchPixels];   // 1 or 0
};

/// Residual, robust weight and cost of every pixel.
MBA_VO_MULTIVERSION
void weighPixels(const ReblurredPatch& predicted, const float* __restrict intensity, int count,
                 const PatchWeighting& weighting, Weighted& __restrict out) {
  const float t = weighting.huber_threshold;
  const float leaving = 0.5F * t * t;
  const float noise2 = weighting.noise * weighting.noise;
  for (int k = 0; k < count; ++k) {
    const float r = intensity[k] - (weighting.gain * predicted.value[k] + weighting.offset);
    const bool valid = r == r;  // false for NaN
    const float residual = valid ? r : 0.0F;
    const float magnitude = std::abs(residual);
    const bool inlier = magnitude <= t;
    const float huber_weight = inlier ? 1.0F : t / magnitude;
    const float huber_cost = inlier ? 0.5F * residual * residual : t * (magnitude - 0.5F * t);
    const float depth = weighting.gain * (predicted.gx[k] * weighting.depth_x + predicted.gy[k] * weighting.depth_y);
    const float certainty = noise2 / (noise2 + depth * depth);
    out.rows[kMoments][k] = residual;
    out.weight[k] = valid ? certainty * huber_weight : 0.0F;
    out.cost[k] = valid ? certainty * huber_cost + (1.0F - certainty) * leaving : leaving;
    out.inlier[k] = valid && inlier ? 1.0F : 0.0F;
    out.valid[k] = valid ? 1.0F : 0.0F;
  }
}

/// Copies one row of moments, with 0 where the pixel is invalid (0 times NaN would be NaN).
MBA_VO_MULTIVERSION
void copyValid(const float* __restrict from, const float* __restrict valid, int count, float* __restrict to) {
  for (int k = 0; k < count; ++k) to[k] = valid[k] > 0.0F ? from[k] : 0.0F;
}

/// sum of w a b over `count` pixels, a multiple of kLanes, in a fixed order.
MBA_VO_MULTIVERSION
float weightedProduct(const float* __restrict w, const float* __restrict a, const float* __restrict b, int count) {
  alignas(64) float lanes[kLanes] = {};
  for (int first = 0; first < count; first += kLanes) {
    for (int k = 0; k < kLanes; ++k) lanes[k] += w[first + k] * a[first + k] * b[first + k];
  }
  float sum = 0.0F;
  for (const float lane : lanes) sum += lane;
  return sum;
}

float sum(const float* values, int count) {
  float total = 0.0F;
  for (int k = 0; k < count; ++k) total += values[k];
  return total;
}

}  // namespace

PatchSums sumPatch(const ReblurredPatch& predicted, const std::array<float, kMaxPatchPixels>& intensity, int size,
                   bool moving, const PatchWeighting& weighting) {
  const int padded = (size + kLanes - 1) / kLanes * kLanes;
  Weighted pixels;
  weighPixels(predicted, intensity.data(), padded, weighting, pixels);
  for (int k = size; k < padded; ++k) {
    pixels.weight[k] = pixels.cost[k] = pixels.inlier[k] = pixels.valid[k] = 0.0F;
    pixels.rows[kMoments][k] = 0.0F;
  }
  const std::array<const float*, kMoments - 1> sources = {
      predicted.gx.data(),   predicted.gy.data(),   predicted.ugx.data(),  predicted.ugy.data(),
      predicted.uugx.data(), predicted.uugy.data(), predicted.value.data()};
  for (int i = 0; i < kMoments - 1; ++i) {
    copyValid(sources[static_cast<std::size_t>(i)], pixels.valid, padded, pixels.rows[i]);
  }
  std::copy(pixels.valid, pixels.valid + padded, pixels.rows[kMoments - 1]);

  PatchSums sums;
  sums.moments.setZero();
  sums.residuals.setZero();
  const auto used = [&](int i) { return moving || i < 2 || i >= 6; };
  for (int i = 0; i < kMoments; ++i) {
    if (!used(i)) continue;
    for (int j = i; j < kMoments; ++j) {
      if (!used(j)) continue;
      sums.moments(i, j) = weightedProduct(pixels.weight, pixels.rows[i], pixels.rows[j], padded);
      sums.moments(j, i) = sums.moments(i, j);
    }
    sums.residuals(i) = weightedProduct(pixels.weight, pixels.rows[i], pixels.rows[kMoments], padded);
  }
  sums.cost = sum(pixels.cost, size);
  sums.weighted_squares = weightedProduct(pixels.weight, pixels.rows[kMoments], pixels.rows[kMoments], padded);
  sums.inlier_squares = weightedProduct(pixels.inlier, pixels.rows[kMoments], pixels.rows[kMoments], padded);
  sums.inliers = static_cast<int>(sum(pixels.inlier, size));
  sums.pixels = static_cast<int>(sum(pixels.valid, size));
  return sums;
}

}  // namespace mba_vo
