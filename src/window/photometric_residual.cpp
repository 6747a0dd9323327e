#include "mba_vo/window/photometric_residual.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <Eigen/LU>

#include "mba_vo/blur/multiversion.h"
#include "mba_vo/blur/reblur.h"

namespace mba_vo {
namespace {

const PatchPattern& pattern() {
  static const PatchPattern kPattern = PatchPattern::spread8();
  return kPattern;
}

float squaredGradient(const cv::Mat1f& image, int x, int y) {
  const float gx = 0.5F * (image(y, x + 1) - image(y, x - 1));
  const float gy = 0.5F * (image(y + 1, x) - image(y - 1, x));
  return gx * gx + gy * gy;
}

void readTarget(const PairGeometry& pair, const Eigen::Vector2i& centre, double inverse_depth,
                const ResidualOptions& options, const Eigen::Vector2d& slope,
                std::array<float, kMaxPatchPixels>& intensity) {
  if (pair.commuted) {
    pair.commuted->read(*pair.target_image, centre.cast<double>(), inverse_depth, pattern(), options.sample_spacing_px,
                        options.max_samples, intensity, slope);
    return;
  }
  for (std::size_t k = 0; k < kResidualPixels; ++k) {
    intensity[k] = pair.target_image->intensity(centre.y() + pattern().dy[k], centre.x() + pattern().dx[k]);
  }
}

constexpr int kPixels = kResidualPixels;
constexpr int kSize = 8;  // of z = [gx gy ugx ugy, J_a, J_b, r], padded

/// Residuals of all pixels.
MBA_VO_MULTIVERSION
void comparePixels(const PairGeometry& pair, const PatchResidual& residual, const ReblurredPatch& reblurred,
                   PatchComparison& __restrict comparison) {
  const float gain = comparison.gain;
  const float offset_host = pair.offset_host;
  const float offset_target = pair.offset_target;
  for (std::size_t k = 0; k < kPixels; ++k) {
    const float normalized = gain * (reblurred.value[k] - offset_host);
    comparison.gx[k] = -gain * reblurred.gx[k];
    comparison.gy[k] = -gain * reblurred.gy[k];
    comparison.ugx[k] = -gain * reblurred.ugx[k];
    comparison.ugy[k] = -gain * reblurred.ugy[k];
    comparison.normalized[k] = normalized;
    comparison.r[k] = residual.intensity[k] - normalized - offset_target;
  }
}

/// Weights by Huber threshold; returns the energy.
MBA_VO_MULTIVERSION
float weighPixels(const std::array<float, kResidualPixels>& r, const std::array<float, kResidualPixels>& weight,
                  float huber_threshold, PatchComparison::Pixels& __restrict weighted) {
  float energy[kPixels];
  for (std::size_t k = 0; k < kPixels; ++k) {
    const float magnitude = std::abs(r[k]);
    const float quotient = huber_threshold / magnitude;
    const float huber = magnitude <= huber_threshold ? 1.0F : quotient;
    const float w = weight[k] * huber;
    weighted[k] = w;
    energy[k] = w * r[k] * r[k] * (2.0F - huber);
  }
  return ((energy[0] + energy[4]) + (energy[2] + energy[6])) + ((energy[1] + energy[5]) + (energy[3] + energy[7]));
}

using FloatRow = float __attribute__((vector_size(kSize * sizeof(float))));
using DoubleRow = double __attribute__((vector_size(kSize * sizeof(double))));

/// Products of the sums S = sum_k w_k z_k z_k^T over the pixels with the Jacobians E of pose and inverse depth.
struct JacobianProducts {
  alignas(64) double E[4][kSize];        // d path / d (pose, inverse depth), zero padding
  alignas(64) double S[kSize][kSize];    // symmetric
  alignas(64) double SE[kSize][kSize];   // S E
  alignas(64) double ESE[kSize][kSize];  // E^T S E
};

/// From S on in double: it is rounded but common to all blocks, so that directions which cannot be observed stay
/// unobserved.
MBA_VO_MULTIVERSION
void multiplyOut(const PatchComparison& c, int rows, JacobianProducts& p) {
  alignas(64) float z[kPixels][kSize];  // times sqrt(w), so that S is symmetric to the last bit
  for (std::size_t k = 0; k < kPixels; ++k) {
    const float root = std::sqrt(c.weight[k]);
    z[k][0] = root * c.gx[k];
    z[k][1] = root * c.gy[k];
    z[k][2] = root * c.ugx[k];
    z[k][3] = root * c.ugy[k];
    z[k][4] = -root * c.normalized[k];
    z[k][5] = -root;
    z[k][6] = root * c.r[k];
    z[k][7] = 0.0F;
  }
  FloatRow sums[kSize - 1] = {};
  for (const auto& pixel : z) {
    FloatRow row;
    std::memcpy(&row, pixel, sizeof(row));
    for (int i = 0; i < kSize - 1; ++i) sums[i] += pixel[i] * row;
  }
  DoubleRow E[4];
  std::memcpy(E, p.E, sizeof(E));
  for (int i = 0; i < kSize - 1; ++i) {
    const DoubleRow S = __builtin_convertvector(sums[i], DoubleRow);
    DoubleRow SE = S[0] * E[0] + S[1] * E[1];
    if (rows > 2) SE += S[2] * E[2] + S[3] * E[3];
    std::memcpy(p.S[i], &S, sizeof(S));
    std::memcpy(p.SE[i], &SE, sizeof(SE));
  }
  DoubleRow SE[4];
  std::memcpy(SE, p.SE, sizeof(SE));
  for (int q = 0; q < kSize - 1; ++q) {
    DoubleRow ESE = p.E[0][q] * SE[0] + p.E[1][q] * SE[1];
    if (rows > 2) ESE += p.E[2][q] * SE[2] + p.E[3][q] * SE[3];
    std::memcpy(p.ESE[q], &ESE, sizeof(ESE));
  }
}

}  // namespace

void placePixels(const PairGeometry& pair, const Eigen::Vector2d& host_pixel, double inverse_depth,
                 const ResidualOptions& options, PatchResidual& residual, const Eigen::Vector2d& slope) {
  residual.has_pixels = false;
  residual.energy = residual.trial_energy = kNoEnergy;
  const std::optional<Eigen::Vector2d> projected = projectIntoTarget(pair, host_pixel, inverse_depth);
  if (!projected) return;
  const Eigen::Vector2d& projection = *projected;
  if (!pair.target_image->camera.contains(projection, pattern().radius + 1.5)) return;
  residual.centre = projection.array().round().cast<int>();
  const cv::Mat1f& image = pair.target_image->intensity;
  std::array<float, kMaxPatchPixels> intensity;
  readTarget(pair, residual.centre, inverse_depth, options, slope, intensity);
  const float c2 = options.gradient_constant * options.gradient_constant;
  float sum = 0.0F;
  for (std::size_t k = 0; k < kResidualPixels; ++k) {
    const int x = residual.centre.x() + pattern().dx[k];
    const int y = residual.centre.y() + pattern().dy[k];
    residual.intensity[k] = intensity[k];
    residual.weight[k] = c2 > 0.0F ? c2 / (c2 + squaredGradient(image, x, y)) : 1.0F;
    sum += residual.intensity[k] + residual.weight[k];
  }
  residual.has_pixels = std::isfinite(sum);
}

float projectionDrift(const PatchPath& path, const Eigen::Vector2d& host_pixel) {
  const Eigen::Vector2f offset = path.c0 - host_pixel.cast<float>();
  return (path.A0.inverse() * offset).lpNorm<Eigen::Infinity>();
}

bool comparePatch(const PairGeometry& pair, const PatchPath& path, const PatchResidual& residual,
                  const ResidualOptions& options, PatchComparison& comparison) {
  ReblurredPatch reblurred;
  return comparePatch(pair, path, residual, options, comparison, reblurred);
}

bool comparePatch(const PairGeometry& pair, const PatchPath& path, const PatchResidual& residual,
                  const ResidualOptions& options, PatchComparison& comparison, ReblurredPatch& reblurred) {
  const int samples = pair.blurred ? sampleCount(path.length(), options.sample_spacing_px, options.max_samples) : 1;
  reblurPatch(*pair.host_image, path, pattern(), samples, reblurred);
  comparison.gain =
      pair.gain * static_cast<float>(pair.vignette.at(path.c0.cast<double>(), residual.centre.cast<double>()));
  comparePixels(pair, residual, reblurred, comparison);
  comparison.misfit = weighPixels(comparison.r, residual.weight, options.huber_threshold, comparison.weight);
  weighComparison(pair, residual, options, comparison);
  return std::isfinite(comparison.energy);
}

void weighComparison(const PairGeometry& pair, const PatchResidual& residual, const ResidualOptions& options,
                     PatchComparison& comparison) {
  const float threshold = std::min(pair.huber_threshold, options.huber_threshold);
  std::array<float, kResidualPixels> weight;
  std::transform(residual.weight.begin(), residual.weight.end(), weight.begin(),
                 [&](float w) { return pair.precision * w; });
  comparison.energy = weighPixels(comparison.r, weight, threshold, comparison.weight);
}

void assembleSystem(const PatchComparison& comparison, const PatchPath& path, bool blurred, ResidualSystem& system) {
  JacobianProducts p;
  const int rows = blurred ? 4 : 2;  // sharp patches have no moments in u
  for (int i = 0; i < 4; ++i) {
    const auto part = static_cast<std::size_t>(i / 2);
    for (int c = 0; c < 6; ++c) p.E[i][c] = path.J_pose[part](i % 2, c);
    p.E[i][6] = path.J_inverse_depth[part](i % 2);
    p.E[i][7] = 0.0;
  }
  multiplyOut(comparison, rows, p);
  for (int c = 0; c < 6; ++c) {
    for (int q = 0; q < 6; ++q) system.H(q, c) = p.ESE[c][q];
    system.H(6, c) = system.H(c, 6) = p.SE[4][c];
    system.H(7, c) = system.H(c, 7) = p.SE[5][c];
    system.b(c) = p.SE[6][c];
    system.H_state_depth(c) = p.ESE[6][c];
  }
  system.H(6, 6) = p.S[4][4];
  system.H(6, 7) = system.H(7, 6) = p.S[4][5];
  system.H(7, 7) = p.S[5][5];
  system.b(6) = p.S[4][6];
  system.b(7) = p.S[5][6];
  system.H_state_depth(6) = p.SE[4][6];
  system.H_state_depth(7) = p.SE[5][6];
  system.H_depth = p.ESE[6][6];
  system.b_depth = p.SE[6][6];
}

DepthSystem assembleDepth(const PatchComparison& comparison, const PatchPath& path, bool blurred) {
  const Eigen::Vector2f J0 = path.J_inverse_depth[0].cast<float>();
  const Eigen::Vector2f J1 = blurred ? Eigen::Vector2f(path.J_inverse_depth[1].cast<float>()) : Eigen::Vector2f::Zero();
  float H = 0.0F;
  float b = 0.0F;
  for (std::size_t k = 0; k < kPixels; ++k) {
    const float J =
        J0.x() * comparison.gx[k] + J0.y() * comparison.gy[k] + J1.x() * comparison.ugx[k] + J1.y() * comparison.ugy[k];
    H += comparison.weight[k] * J * J;
    b += comparison.weight[k] * J * comparison.r[k];
  }
  return {static_cast<double>(H), static_cast<double>(b)};
}

}  // namespace mba_vo
