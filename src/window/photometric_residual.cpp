#include "mba_vo/window/photometric_residual.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "mba_vo/blur/reblur.h"
#include "mba_vo/image/multiversion.h"

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
    comparison.J_a[k] = -normalized;
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

/// Of the two images of a patch, to either side: further apart the one shows what the other cannot
/// (docs/decisions/2026-11-29-zoom.md).
constexpr float kMostZoom = 1.5F;

/// Whether host and target show a patch nearly equally large.
bool equallyLarge(const PairGeometry& pair, const PatchPath& path) {
  const PinholeCamera& host = pair.host_camera;
  const PinholeCamera& target = pair.target_camera;
  const auto pixels = static_cast<float>(target.fx * target.fy / (host.fx * host.fy));  // one image may be binned
  const float area = pixels * std::abs(path.A0.determinant());  // in the host, of the same in the target
  return area <= kMostZoom * kMostZoom && area * kMostZoom * kMostZoom >= 1.0F;
}

bool compare(const PairGeometry& pair, const PatchPath& path, const PatchResidual& residual,
             const ResidualOptions& options, GradientMoments wanted, PatchComparison& comparison,
             ReblurredPatch& reblurred) {
  if (!equallyLarge(pair, path)) return false;
  const int samples = pair.blurred ? sampleCount(path.length(), options.sample_spacing_px, options.max_samples) : 1;
  reblurPatch(*pair.host_image, path, pattern(), samples, reblurred, wanted);
  comparison.gain =
      pair.gain * static_cast<float>(pair.vignette.at(path.c0.cast<double>(), residual.centre.cast<double>()));
  comparePixels(pair, residual, reblurred, comparison);
  comparison.misfit = weighPixels(comparison.r, residual.weight, options.huber_threshold, comparison.weight);
  weighComparison(pair, residual, options, comparison);
  return std::isfinite(comparison.energy);
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
  return compare(pair, path, residual, options, GradientMoments::kFirst, comparison, reblurred);
}

bool comparePatch(const PairGeometry& pair, const PatchPath& path, const PatchResidual& residual,
                  const ResidualOptions& options, PatchComparison& comparison, ReblurredPatch& reblurred) {
  return compare(pair, path, residual, options, GradientMoments::kSecond, comparison, reblurred);
}

void weighComparison(const PairGeometry& pair, const PatchResidual& residual, const ResidualOptions& options,
                     PatchComparison& comparison) {
  const float threshold = std::min(pair.huber_threshold, options.huber_threshold);
  std::array<float, kResidualPixels> weight;
  std::transform(residual.weight.begin(), residual.weight.end(), weight.begin(),
                 [&](float w) { return pair.precision * w; });
  comparison.energy = weighPixels(comparison.r, weight, threshold, comparison.weight);
}

void assembleSystem(const PatchComparison& c, const PatchPath& path, bool blurred, ResidualSystem& system) {
  MomentProducts<8> p;
  p.E.block<2, 7>(0, 0) << path.J_pose[0], path.J_inverse_depth[0];
  p.E.block<2, 7>(2, 0) << path.J_pose[1], path.J_inverse_depth[1];
  // Sharp patches have no moments in u.
  multiplyOut(c.weight, {&c.gx, &c.gy, &c.ugx, &c.ugy, &c.J_a, &kJacobianOfOffset, &c.r}, blurred ? 4 : 2, 7, p);
  system.H << p.ESE.topLeftCorner<6, 6>(), p.SE.block<2, 6>(4, 0).transpose(),  //
      p.SE.block<2, 6>(4, 0), p.S.block<2, 2>(4, 4);
  system.b << p.SE.block<1, 6>(6, 0).transpose(), p.S.block<2, 1>(4, 6);
  system.H_state_depth << p.ESE.block<1, 6>(6, 0).transpose(), p.SE.block<2, 1>(4, 6);
  system.H_depth = p.ESE(6, 6);
  system.b_depth = p.SE(6, 6);
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
