#pragma once

#include <optional>
#include <vector>

#include "mba_vo/blur/moment_products.h"
#include "mba_vo/blur/reblur.h"
#include "mba_vo/window/pair_geometry.h"

namespace mba_vo {

struct ResidualOptions {
  float huber_threshold = 9.0F;     // the largest [grey levels]
  float gradient_constant = 50.0F;  // c of the weight c^2 / (c^2 + |gradient|^2); 0 = weight 1 [grey levels / px]
  float sample_spacing_px = 1.25F;  // along the blur path
  int max_samples = 64;
};

/// Places the residual's pixels around the projection of the point, rounded to integers. Leaves it without pixels if
/// the point is behind the target or any pixel is outside or invalid.
void placePixels(const PairGeometry& pair, const Eigen::Vector2d& host_pixel, double inverse_depth,
                 const ResidualOptions& options, PatchResidual& residual,
                 const Eigen::Vector2d& slope = Eigen::Vector2d::Zero());

/// Distance of the point's projection from the centre of the pixel set [px of the target].
float projectionDrift(const PatchPath& path, const Eigen::Vector2d& host_pixel);

/// A residual's pixels beside the re-blurred host: r = B_target - (gain (B_reblurred - b_host) + b_target).
struct PatchComparison {
  using Pixels = SparsePixels;
  alignas(64) Pixels gx, gy, ugx, ugy;  // moments of the host's gradient along the blur path, times -gain
  Pixels J_a;                           // -gain (B_reblurred - b_host)
  Pixels r;                             // [grey levels]
  float gain = 1.0F;                    // with the vignettes that the images lack
  Pixels weight;                        // of r^2, with Huber's and the precision [1 / grey level^2]
  float energy = 0.0F;                  // Huber energy, with the precision
  float misfit = 0.0F;                  // with the options' threshold and without the precision [grey levels^2]
};

/// Of the residual's pixels by the target's b.
inline constexpr SparsePixels kJacobianOfOffset{-1.0F, -1.0F, -1.0F, -1.0F, -1.0F, -1.0F, -1.0F, -1.0F};

/// False if the path leaves the host, or host and target show the patch in sizes that are too different.
bool comparePatch(const PairGeometry& pair, const PatchPath& path, const PatchResidual& residual,
                  const ResidualOptions& options, PatchComparison& comparison);

/// The same; `reblurred`: the host's patch, for what is not kept of it.
bool comparePatch(const PairGeometry& pair, const PatchPath& path, const PatchResidual& residual,
                  const ResidualOptions& options, PatchComparison& comparison, ReblurredPatch& reblurred);

/// Weights and energy for the pair's Huber threshold and precision, all else as it is.
void weighComparison(const PairGeometry& pair, const PatchResidual& residual, const ResidualOptions& options,
                     PatchComparison& comparison);

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
