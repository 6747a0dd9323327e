#include "mba_vo/mapping/photometric_residual.h"

#include <cmath>

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
                const ResidualOptions& options, std::array<float, kMaxPatchPixels>& intensity) {
  if (pair.commuted) {
    pair.commuted->read(*pair.target_image, centre.cast<double>(), inverse_depth, pattern(), options.sample_spacing_px,
                        options.max_samples, intensity);
    return;
  }
  for (std::size_t k = 0; k < kResidualPixels; ++k) {
    intensity[k] = pair.target_image->intensity(centre.y() + pattern().dy[k], centre.x() + pattern().dx[k]);
  }
}

constexpr int kPixels = kResidualPixels;
constexpr int kSize = 8;  // of z, padded

/// Residuals, weights and energies of all pixels.
MBA_VO_MULTIVERSION
void weighPixels(const PairGeometry& pair, const PatchResidual& residual, float huber_threshold,
                 PatchComparison& comparison) {
  const float* __restrict value = comparison.reblurred.value.data();
  const float* __restrict intensity = residual.intensity.data();
  const float* __restrict weight = residual.weight.data();
  const float gain = pair.gain;
  const float offset_host = pair.offset_host;
  const float offset_target = pair.offset_target;
  float energy[kPixels];
  for (int k = 0; k < kPixels; ++k) {
    const float normalized = gain * (value[k] - offset_host);
    const float r = intensity[k] - normalized - offset_target;
    const float magnitude = std::abs(r);
    const float quotient = huber_threshold / magnitude;
    const float huber = magnitude <= huber_threshold ? 1.0F : quotient;
    const float w = weight[k] * huber;
    comparison.normalized[k] = normalized;
    comparison.r[k] = r;
    comparison.weight[k] = w;
    energy[k] = w * r * r * (2.0F - huber);
  }
  comparison.energy =
      ((energy[0] + energy[4]) + (energy[2] + energy[6])) + ((energy[1] + energy[5]) + (energy[3] + energy[7]));
}

MBA_VO_MULTIVERSION
void sumProducts(const float* __restrict z, const float* __restrict weight, float* __restrict out) {
  float sums[kSize * kSize] = {};
  for (int k = 0; k < kPixels; ++k) {
    const float* __restrict row = z + kSize * k;
#pragma GCC unroll 8
    for (int i = 0; i < kSize; ++i) {
      const float factor = weight[k] * row[i];
      for (int j = 0; j < kSize; ++j) sums[kSize * i + j] += factor * row[j];
    }
  }
  for (int i = 0; i < kSize * kSize; ++i) out[i] = sums[i];
}

/// Products of the image-gradient moments with the Jacobians of pose and inverse depth, E: one row of eight per moment.
struct JacobianProducts {
  alignas(64) double S[kSize][kSize];    // symmetric; all of z
  alignas(64) double E[4][kSize];        // d path / d (pose, inverse depth), zero padding
  alignas(64) double ESE[kSize][kSize];  // E^T S E, without the padding's row
  alignas(64) double SE[kSize][kSize];   // S E
};

MBA_VO_MULTIVERSION
void multiplyOut(int rows, JacobianProducts& p) {
  for (int i = 0; i < kSize - 1; ++i) {
    double sum[kSize] = {};
    for (int j = 0; j < rows; ++j) {
      for (int c = 0; c < kSize; ++c) sum[c] += p.S[i][j] * p.E[j][c];
    }
    for (int c = 0; c < kSize; ++c) p.SE[i][c] = sum[c];
  }
  for (int q = 0; q < kSize - 1; ++q) {
    double sum[kSize] = {};
    for (int i = 0; i < rows; ++i) {
      for (int c = 0; c < kSize; ++c) sum[c] += p.E[i][q] * p.SE[i][c];
    }
    for (int c = 0; c < kSize; ++c) p.ESE[q][c] = sum[c];
  }
}

}  // namespace

PairGeometry makePairGeometry(const KeyframeState& host, const KeyframeState& target, bool reblur_targets) {
  PairGeometry pair;
  pair.blurred = reblur_targets && !target.xi.isZero(0.0);
  pair.host_image = &host.sharp->level(0);
  pair.target_image = reblur_targets ? &target.original->level(0) : &target.sharp->level(0);
  const auto makePaths = [&](const SE3& T_host_target) {
    return FixedMotionPathMaker(pair.host_image->camera, pair.target_image->camera,
                                {T_host_target, target.xi, pair.blurred ? 1.0 : 0.0});
  };
  const SE3 T_host_target = host.T_map_keyframe().inverse() * target.T_map_keyframe();
  const SE3 T_host_target_first = host.T_linear.inverse() * target.T_linear;
  pair.T_target_host = T_host_target.inverse();
  if (reblur_targets && !host.image_xi.isZero(0.0)) {
    pair.commuted.emplace(pair.host_image->camera, pair.target_image->camera, T_host_target, host.image_xi);
  }
  pair.path = makePaths(T_host_target);
  if (!host.delta.head<6>().isZero(0.0) || !target.delta.head<6>().isZero(0.0)) {
    pair.first_path = makePaths(T_host_target_first);
  }
  const AffineBrightness host_brightness = host.brightness();
  const AffineBrightness target_brightness = target.brightness();
  pair.gain = static_cast<float>(std::exp(target_brightness.a - host_brightness.a));
  pair.offset_host = static_cast<float>(host_brightness.b);
  pair.offset_target = static_cast<float>(target_brightness.b);
  // T_ht' = Exp(-d_h) T_ht = T_ht Exp(-Ad(T_ht^-1) d_h); a enters as a_t - a_h; b_h as -gain b_h.
  pair.J_host.topLeftCorner<6, 6>() = -T_host_target_first.inverse().adjoint();
  pair.J_host(6, 6) = -1.0;
  pair.J_host(7, 7) = -std::exp(target.brightness_linear.a - host.brightness_linear.a);
  return pair;
}

std::vector<PairGeometry> makePairGeometries(const WindowState& state, bool reblur_targets) {
  const int n = state.size();
  std::vector<PairGeometry> pairs(static_cast<std::size_t>(n * n));
  for (int h = 0; h < n; ++h) {
    for (int t = 0; t < n; ++t) {
      if (h == t) continue;
      pairs[static_cast<std::size_t>(h * n + t)] =
          makePairGeometry(state.keyframe(h), state.keyframe(t), reblur_targets);
    }
  }
  return pairs;
}

void placePixels(const PairGeometry& pair, const Eigen::Vector2d& host_pixel, double inverse_depth,
                 const ResidualOptions& options, PatchResidual& residual) {
  residual.has_pixels = false;
  residual.energy = residual.trial_energy = kNoEnergy;
  const Eigen::Vector3d ray = pair.host_image->camera.unproject(host_pixel);
  const Eigen::Vector3d point = pair.T_target_host.rotation() * ray + inverse_depth * pair.T_target_host.translation();
  if (point.z() <= 0.0) return;
  const Eigen::Vector2d projection = pair.target_image->camera.project(point);
  if (!pair.target_image->camera.contains(projection, pattern().radius + 1.5)) return;
  residual.centre = projection.array().round().cast<int>();
  const cv::Mat1f& image = pair.target_image->intensity;
  std::array<float, kMaxPatchPixels> intensity;
  readTarget(pair, residual.centre, inverse_depth, options, intensity);
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
  const int samples = pair.blurred ? sampleCount(path.length(), options.sample_spacing_px, options.max_samples) : 1;
  reblurPatch(*pair.host_image, path, pattern(), samples, comparison.reblurred);
  weighPixels(pair, residual, options.huber_threshold, comparison);
  return std::isfinite(comparison.energy);
}

void sumMoments(const PairGeometry& pair, const PatchComparison& comparison, PatchMoments& moments) {
  const ReblurredPatch& patch = comparison.reblurred;
  alignas(64) float z[kPixels * kSize];
  for (std::size_t k = 0; k < kPixels; ++k) {
    float* row = z + kSize * k;
    row[0] = -pair.gain * patch.gx[k];
    row[1] = -pair.gain * patch.gy[k];
    row[2] = -pair.gain * patch.ugx[k];
    row[3] = -pair.gain * patch.ugy[k];
    row[4] = -comparison.normalized[k];
    row[5] = -1.0F;
    row[6] = comparison.r[k];
    row[7] = 0.0F;
  }
  sumProducts(z, comparison.weight.data(), moments.data());
}

void assembleSystem(const PatchMoments& moments, const PatchPath& path, bool blurred, ResidualSystem& system) {
  // From here on in double: the sums are rounded but common to all blocks, so that directions which cannot be observed
  // stay unobserved.
  JacobianProducts p;
  for (int i = 0; i < kSize; ++i) {
    for (int j = 0; j < kSize; ++j) p.S[i][j] = 0.5 * (static_cast<double>(moments(i, j)) + moments(j, i));
  }
  const int rows = blurred ? 4 : 2;  // sharp patches have no moments in u
  for (int i = 0; i < rows; ++i) {
    const auto part = static_cast<std::size_t>(i / 2);
    for (int c = 0; c < 6; ++c) p.E[i][c] = path.J_pose[part](i % 2, c);
    p.E[i][6] = path.J_inverse_depth[part](i % 2);
    p.E[i][7] = 0.0;
  }
  multiplyOut(rows, p);
  for (int c = 0; c < 6; ++c) {
    for (int q = 0; q < 6; ++q) system.H(q, c) = p.ESE[q][c];
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

DepthSystem assembleDepth(const PairGeometry& pair, const PatchComparison& comparison, const PatchPath& path) {
  const ReblurredPatch& patch = comparison.reblurred;
  const Eigen::Vector2f J0 = -pair.gain * path.J_inverse_depth[0].cast<float>();
  Eigen::Vector2f J1 = Eigen::Vector2f::Zero();
  if (pair.blurred) J1 = -pair.gain * path.J_inverse_depth[1].cast<float>();
  float H = 0.0F;
  float b = 0.0F;
  for (std::size_t k = 0; k < kPixels; ++k) {
    const float J = J0.x() * patch.gx[k] + J0.y() * patch.gy[k] + J1.x() * patch.ugx[k] + J1.y() * patch.ugy[k];
    H += comparison.weight[k] * J * J;
    b += comparison.weight[k] * J * comparison.r[k];
  }
  return {static_cast<double>(H), static_cast<double>(b)};
}

}  // namespace mba_vo
