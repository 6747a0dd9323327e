#include "mba_vo/mapping/photometric_residual.h"

#include <cmath>

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

/// J^T S J for the first `Rows` image-gradient moments; sharp patches have no moments in u.
template <int Rows>
void assembleRows(const Eigen::Matrix<double, 7, 7>& sums, const PatchPath& path, ResidualSystem& system) {
  Eigen::Matrix<double, Rows, 6> J;
  Eigen::Matrix<double, Rows, 1> J_depth;
  for (int part = 0; part < Rows / 2; ++part) {
    const auto i = static_cast<std::size_t>(part);
    J.template middleRows<2>(2 * part) = path.J_pose[i];
    J_depth.template segment<2>(2 * part) = path.J_inverse_depth[i];
  }
  const Eigen::Matrix<double, Rows, Rows> S = sums.topLeftCorner<Rows, Rows>();
  const Eigen::Matrix<double, Rows, 6> S_J = S * J;
  const Eigen::Matrix<double, Rows, 1> S_J_depth = S * J_depth;
  system.H.topLeftCorner<6, 6>().noalias() = J.transpose() * S_J;
  system.H.topRightCorner<6, 2>().noalias() = J.transpose() * sums.block<Rows, 2>(0, 4);
  system.H.bottomLeftCorner<2, 6>() = system.H.topRightCorner<6, 2>().transpose();
  system.H.bottomRightCorner<2, 2>() = sums.block<2, 2>(4, 4);
  system.b.head<6>().noalias() = J.transpose() * sums.block<Rows, 1>(0, 6);
  system.b.tail<2>() = sums.block<2, 1>(4, 6);
  system.H_state_depth.head<6>().noalias() = J.transpose() * S_J_depth;
  system.H_state_depth.tail<2>().noalias() = sums.block<2, Rows>(4, 0) * J_depth;
  system.H_depth = J_depth.dot(S_J_depth);
  system.b_depth = J_depth.dot(sums.block<Rows, 1>(0, 6));
}

}  // namespace

PairGeometry makePairGeometry(const KeyframeState& host, const KeyframeState& target, bool reblur_targets) {
  PairGeometry pair;
  pair.blurred = reblur_targets && !target.xi.isZero(0.0);
  pair.host_image = &host.sharp->level(0);
  pair.target_image = reblur_targets ? &target.original->level(0) : &target.sharp->level(0);
  const auto makePaths = [&](const SE3& T_host_target) {
    return PatchPathMaker(pair.host_image->camera, pair.target_image->camera,
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

bool evaluatePatch(const PairGeometry& pair, const PatchPath& path, const PatchResidual& residual,
                   const ResidualOptions& options, PatchMoments& moments) {
  ReblurredPatch patch;
  const int samples = pair.blurred ? sampleCount(path.length(), options.sample_spacing_px, options.max_samples) : 1;
  reblurPatch(*pair.host_image, path, pattern(), samples, patch);

  Eigen::Matrix<float, 8, kResidualPixels> z, weighted;  // one column per pixel
  moments.energy = 0.0F;
  for (std::size_t k = 0; k < kResidualPixels; ++k) {
    const float normalized = pair.gain * (patch.value[k] - pair.offset_host);
    const float r = residual.intensity[k] - normalized - pair.offset_target;
    const float magnitude = std::abs(r);
    const float huber = magnitude <= options.huber_threshold ? 1.0F : options.huber_threshold / magnitude;
    const float weight = residual.weight[k] * huber;
    moments.energy += weight * r * r * (2.0F - huber);
    const auto column = static_cast<Eigen::Index>(k);
    z.col(column) << -pair.gain * patch.gx[k], -pair.gain * patch.gy[k], -pair.gain * patch.ugx[k],
        -pair.gain * patch.ugy[k], -normalized, -1.0F, r, 0.0F;
    weighted.col(column) = weight * z.col(column);
  }
  if (!std::isfinite(moments.energy)) return false;
  moments.sums.noalias() = z.lazyProduct(weighted.transpose());
  return true;
}

void assembleSystem(const PatchMoments& moments, const PatchPath& path, bool blurred, ResidualSystem& system) {
  // From here on in double: the sums are rounded but common to all blocks, so that directions which cannot be observed
  // stay unobserved.
  Eigen::Matrix<double, 7, 7> sums = moments.sums.topLeftCorner<7, 7>().cast<double>();
  sums = (0.5 * (sums + sums.transpose())).eval();
  if (blurred) {
    assembleRows<4>(sums, path, system);
  } else {
    assembleRows<2>(sums, path, system);
  }
}

}  // namespace mba_vo
