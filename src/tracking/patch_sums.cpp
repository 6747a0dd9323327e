#include "mba_vo/tracking/patch_sums.h"

#include <cmath>

#include "mba_vo/image/multiversion.h"

namespace mba_vo {
namespace {

constexpr int kLanes = 16;
constexpr int kMovingRows = kMoments + 1;  // all moments and the residual
constexpr int kStillRows = 5;              // gx, gy, predicted intensity, one, residual

/// Rows of numbers per pixel: moments, the last of them 1, then the residual; 0 where the pixel is invalid.
template <int Rows>
struct Weighted {
  alignas(64) float rows[Rows][kMaxPatchPixels];
  alignas(64) float weight[kMaxPatchPixels];
  alignas(64) float cost[kMaxPatchPixels];
  alignas(64) float squares[kMaxPatchPixels];
  alignas(64) float inlier[kMaxPatchPixels];  // 1 or 0
};

/// Sums over the pixels of a patch: products of all pairs of rows but the residual's own square, upper triangle row by
/// row.
template <int Rows>
struct Products {
  float pairs[Rows * (Rows + 1) / 2 - 1];
  float cost;
  float weighted_squares;
  float inlier_squares;
  float inliers;
  float valid;
};

/// The sum of all lanes in a fixed order, halving.
[[gnu::always_inline]] inline float sumLanes(float* __restrict lanes) {
#pragma GCC unroll 4
  for (int half = kLanes / 2; half > 0; half /= 2) {
#pragma GCC unroll 8
    for (int k = 0; k < half; ++k) lanes[k] += lanes[k + half];
  }
  return lanes[0];
}

[[gnu::always_inline]] inline float sumOf(const float* __restrict a, int count) {
  alignas(64) float lanes[kLanes] = {};
  for (int first = 0; first < count; first += kLanes) {
    for (int k = 0; k < kLanes; ++k) lanes[k] += a[first + k];
  }
  return sumLanes(lanes);
}

/// `count`: a multiple of kLanes.
[[gnu::always_inline]] inline float sumOfProducts(const float* __restrict a, const float* __restrict b, int count) {
  alignas(64) float lanes[kLanes] = {};
  for (int first = 0; first < count; first += kLanes) {
    for (int k = 0; k < kLanes; ++k) lanes[k] += a[first + k] * b[first + k];
  }
  return sumLanes(lanes);
}

/// Residual, robust weight and cost of every pixel. Conditions choose between values that are there anyway: so that the
/// loop is vectorised.
template <int Rows>
[[gnu::always_inline]] inline void weighPixels(const ReblurredPatch& predicted, const float* __restrict intensity,
                                               int count, const PatchWeighting& weighting,
                                               Weighted<Rows>& __restrict out) {
  const float t = weighting.huber_threshold;
  const float inlier_limit = weighting.inlier_threshold;
  const float leaving = 0.5F * t * t;
  const float noise2 = weighting.noise * weighting.noise;
#pragma GCC unroll 1
  for (int k = 0; k < count; ++k) {
    const float r = intensity[k] - (weighting.gain * predicted.value[k] + weighting.offset);
    const bool valid = r == r;  // false for NaN
    const float residual = valid ? r : 0.0F;
    const float magnitude = std::abs(residual);
    const bool small = magnitude <= t;
    const bool inlier = magnitude <= inlier_limit;
    const float beyond = t / magnitude;
    const float huber_weight = small ? 1.0F : beyond;
    const float square_cost = 0.5F * residual * residual;
    const float linear_cost = t * (magnitude - 0.5F * t);
    const float huber_cost = small ? square_cost : linear_cost;
    const float limited = inlier ? magnitude : inlier_limit;
    const float depth = weighting.gain * (predicted.gx[k] * weighting.depth_x + predicted.gy[k] * weighting.depth_y);
    const float certainty = noise2 / (noise2 + depth * depth);
    const float weight = certainty * huber_weight;
    const float cost = certainty * huber_cost + (1.0F - certainty) * leaving;
    const float one = valid ? 1.0F : 0.0F;
    out.weight[k] = valid ? weight : 0.0F;
    out.cost[k] = valid ? cost : leaving;
    out.squares[k] = certainty * limited * magnitude;
    out.inlier[k] = inlier ? one : 0.0F;
    out.rows[Rows - 2][k] = one;
    out.rows[Rows - 1][k] = residual;
  }
}

/// Row of numbers with 0 where the pixel is invalid (0 times NaN would be NaN).
[[gnu::always_inline]] inline void copyValid(const float* __restrict from, const float* __restrict valid, int count,
                                             float* __restrict to) {
#pragma GCC unroll 1
  for (int k = 0; k < count; ++k) {
    const float value = from[k];
    to[k] = valid[k] > 0.0F ? value : 0.0F;
  }
}

template <int Rows>
[[gnu::always_inline]] inline void copyMoments(const ReblurredPatch& predicted, int count,
                                               Weighted<Rows>& __restrict out) {
  const float* valid = out.rows[Rows - 2];
  copyValid(predicted.gx.data(), valid, count, out.rows[0]);
  copyValid(predicted.gy.data(), valid, count, out.rows[1]);
  if constexpr (Rows == kMovingRows) {
    copyValid(predicted.ugx.data(), valid, count, out.rows[2]);
    copyValid(predicted.ugy.data(), valid, count, out.rows[3]);
    copyValid(predicted.uugx.data(), valid, count, out.rows[4]);
    copyValid(predicted.uugy.data(), valid, count, out.rows[5]);
  }
  copyValid(predicted.value.data(), valid, count, out.rows[Rows - 3]);
}

/// Inlined into each of the versions below.
template <int Rows>
[[gnu::always_inline]] inline void sumProducts(const ReblurredPatch& predicted, const float* __restrict intensity,
                                               int size, const PatchWeighting& weighting,
                                               Products<Rows>& __restrict out) {
  if (size <= 0) __builtin_unreachable();  // else the compiler warns that nothing may be weighed
  const int count = (size + kLanes - 1) / kLanes * kLanes;
  Weighted<Rows> pixels;
  weighPixels(predicted, intensity, count, weighting, pixels);
  for (int k = size; k < count; ++k) {
    pixels.weight[k] = pixels.cost[k] = pixels.squares[k] = pixels.inlier[k] = 0.0F;
    pixels.rows[Rows - 2][k] = pixels.rows[Rows - 1][k] = 0.0F;
  }
  const float* __restrict valid = pixels.rows[Rows - 2];
#pragma GCC unroll 1
  for (int k = 0; k < count; ++k) {
    const float square = pixels.squares[k];
    pixels.squares[k] = valid[k] > 0.0F ? square : 0.0F;  // the certainty of an invalid pixel is NaN
  }
  copyMoments(predicted, count, pixels);
  float* __restrict pair = out.pairs;
  for (int i = 0; i < Rows - 1; ++i) {
    alignas(64) float weighted[kMaxPatchPixels];
    for (int k = 0; k < count; ++k) weighted[k] = pixels.weight[k] * pixels.rows[i][k];
    for (int j = i; j < Rows; ++j) *pair++ = sumOfProducts(weighted, pixels.rows[j], count);
  }
  const float* __restrict residual = pixels.rows[Rows - 1];
  alignas(64) float inlier_residual[kMaxPatchPixels];
  for (int k = 0; k < count; ++k) inlier_residual[k] = pixels.inlier[k] * residual[k];
  out.inlier_squares = sumOfProducts(inlier_residual, residual, count);
  out.cost = sumOf(pixels.cost, count);
  out.weighted_squares = sumOf(pixels.squares, count);
  out.inliers = sumOf(pixels.inlier, count);
  out.valid = sumOf(pixels.rows[Rows - 2], count);
}

MBA_VO_MULTIVERSION
void sumMoving(const ReblurredPatch& predicted, const float* __restrict intensity, int size,
               const PatchWeighting& weighting, Products<kMovingRows>& __restrict out) {
  sumProducts<kMovingRows>(predicted, intensity, size, weighting, out);
}

MBA_VO_MULTIVERSION
void sumStill(const ReblurredPatch& predicted, const float* __restrict intensity, int size,
              const PatchWeighting& weighting, Products<kStillRows>& __restrict out) {
  sumProducts<kStillRows>(predicted, intensity, size, weighting, out);
}

/// Which moment a row is.
template <int Rows>
constexpr int momentOf(int row) {
  return Rows == kMovingRows || row < 2 ? row : row + kMovingRows - Rows;
}

template <int Rows>
PatchSums toPatchSums(const Products<Rows>& products) {
  PatchSums sums;
  sums.moments.setZero();
  sums.residuals.setZero();
  const float* pair = products.pairs;
  for (int i = 0; i < Rows - 1; ++i) {
    const int row = momentOf<Rows>(i);
    for (int j = i; j < Rows - 1; ++j) {
      const int column = momentOf<Rows>(j);
      sums.moments(row, column) = sums.moments(column, row) = *pair++;
    }
    sums.residuals(row) = *pair++;
  }
  sums.weighted_squares = products.weighted_squares;
  sums.cost = products.cost;
  sums.inlier_squares = products.inlier_squares;
  sums.inliers = static_cast<int>(products.inliers);
  sums.pixels = static_cast<int>(products.valid);
  return sums;
}

}  // namespace

PatchSums sumPatch(const ReblurredPatch& predicted, const std::array<float, kMaxPatchPixels>& intensity, int size,
                   bool moving, const PatchWeighting& weighting) {
  if (moving) {
    Products<kMovingRows> products;
    sumMoving(predicted, intensity.data(), size, weighting, products);
    return toPatchSums(products);
  }
  Products<kStillRows> products;
  sumStill(predicted, intensity.data(), size, weighting, products);
  return toPatchSums(products);
}

}  // namespace mba_vo
