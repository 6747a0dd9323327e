#pragma once

#include <optional>
#include <vector>

#include "mba_vo/blur/commuted_blur.h"
#include "mba_vo/blur/fixed_motion_path.h"
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
  RowMotion rows;                                  // of target and host
  std::optional<FixedMotionPathMaker> path;        // at the current state, with the target's motion
  std::optional<FixedMotionPathMaker> first_path;  // at the linearisation points, if they differ
  std::optional<CommutedBlur> commuted;            // if the host's image is itself blurred
  bool blurred = false;
  float gain = 1.0F;                 // exp(a_target - a_host)
  float offset_host = 0.0F;          // b_host
  float offset_target = 0.0F;        // b_target
  Matrix8 J_host = Matrix8::Zero();  // d (target's states) / d (host's states) with equal effect on the residual
};

PairGeometry makePairGeometry(const KeyframeState& host, const KeyframeState& target, bool reblur_targets);

/// All pairs of the window; that of a host in a target is number host * keyframes + target.
std::vector<PairGeometry> makePairGeometries(const WindowState& state, bool reblur_targets);

/// Places the residual's pixels around the projection of the point, rounded to integers. Leaves it without pixels if
/// the point is behind the target or any pixel is outside or invalid.
void placePixels(const PairGeometry& pair, const Eigen::Vector2d& host_pixel, double inverse_depth,
                 const ResidualOptions& options, PatchResidual& residual,
                 const Eigen::Vector2d& slope = Eigen::Vector2d::Zero());

/// Distance of the point's projection from the centre of the pixel set [px of the target].
float projectionDrift(const PatchPath& path, const Eigen::Vector2d& host_pixel);

/// A residual's pixels beside the re-blurred host: r = B_target - (gain (B_reblurred - b_host) + b_target).
struct PatchComparison {
  using Pixels = std::array<float, kResidualPixels>;
  alignas(64) Pixels gx, gy, ugx, ugy;  // moments of the host's gradient along the blur path, times -gain
  Pixels normalized;                    // gain (B_reblurred - b_host)
  Pixels r;                             // [grey levels]
  Pixels weight;                        // of r^2, with Huber's
  float energy = 0.0F;                  // Huber energy [grey levels^2]
};

/// False if the path leaves the host.
bool comparePatch(const PairGeometry& pair, const PatchPath& path, const PatchResidual& residual,
                  const ResidualOptions& options, PatchComparison& comparison);

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
void assembleSystem(const PatchComparison& comparison, const PatchPath& path, bool blurred, ResidualSystem& system);

/// The same for the inverse depth alone.
struct DepthSystem {
  double H = 0.0;
  double b = 0.0;
};

DepthSystem assembleDepth(const PatchComparison& comparison, const PatchPath& path, bool blurred);

}  // namespace mba_vo
