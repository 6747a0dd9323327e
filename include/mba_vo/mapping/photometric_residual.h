#pragma once

#include <optional>

#include "mba_vo/blur/commuted_blur.h"
#include "mba_vo/blur/patch_path.h"
#include "mba_vo/mapping/window_state.h"

namespace mba_vo {

struct ResidualOptions {
  float huber_threshold = 9.0F;     // [grey levels]
  float gradient_constant = 50.0F;  // c of the weight c^2 / (c^2 + |gradient|^2); 0 = weight 1 [grey levels / px]
  float sample_spacing_px = 1.25F;  // along the blur path
  int max_samples = 64;
};

/// What the residuals of all points of one host in one target share.
struct PairGeometry {
  const ImageLevel* host_image = nullptr;
  const ImageLevel* target_image = nullptr;
  SE3 T_target_host;
  std::optional<PatchPathMaker> path;        // at the current state, with the target's motion
  std::optional<PatchPathMaker> first_path;  // at the linearisation points, if they differ
  std::optional<CommutedBlur> commuted;      // if the host's image is itself blurred
  bool blurred = false;
  float gain = 1.0F;                 // exp(a_target - a_host)
  float offset_host = 0.0F;          // b_host
  float offset_target = 0.0F;        // b_target
  Matrix8 J_host = Matrix8::Zero();  // d (target's states) / d (host's states) with equal effect on the residual
};

PairGeometry makePairGeometry(const KeyframeState& host, const KeyframeState& target, bool reblur_targets);

/// Places the residual's pixels around the projection of the point, rounded to integers. Leaves it without pixels if
/// the point is behind the target or any pixel is outside or invalid.
void placePixels(const PairGeometry& pair, const Eigen::Vector2d& host_pixel, double inverse_depth,
                 const ResidualOptions& options, PatchResidual& residual);

/// Weighted sums over the pixels of products of z = [gx gy ugx ugy, J_a, J_b, r]: image gradient along the blur path
/// (already times -gain), derivatives for a and b of the target, residual.
struct PatchMoments {
  Eigen::Matrix<float, 8, 8> sums;  // the last row and column are zero padding
  float energy = 0.0F;              // Huber energy [grey levels^2]
};

/// Residual of one patch: r = B_target - (gain (B_reblurred - b_host) + b_target). False if the path leaves the host.
bool evaluatePatch(const PairGeometry& pair, const PatchPath& path, const PatchResidual& residual,
                   const ResidualOptions& options, PatchMoments& moments);

/// Gauss-Newton terms of one residual in the target's states (pose, a, b) and the inverse depth.
struct ResidualSystem {
  Matrix8 H;
  Vector8 b;
  Vector8 H_state_depth;
  double H_depth = 0.0;
  double b_depth = 0.0;
};

/// `path` supplies the geometric Jacobians; it is that of the linearisation points if those differ from the current
/// state.
void assembleSystem(const PatchMoments& moments, const PatchPath& path, bool blurred, ResidualSystem& system);

}  // namespace mba_vo
