#pragma once

#include <optional>
#include <vector>

#include "mba_vo/blur/commuted_blur.h"
#include "mba_vo/blur/fixed_motion_path.h"
#include "mba_vo/window/window_state.h"

namespace mba_vo {

/// What the residuals of all points of one host in one target share.
struct PairGeometry {
  const ImageLevel* host_image = nullptr;
  const ImageLevel* target_image = nullptr;
  SE3 T_target_host;
  RowMotion rows;                            // of target and host
  PinholeCamera host_camera, target_camera;  // with the row time as is known now
  CalibrationCorrection lacking_host, lacking_target;
  VignetteRatio vignette;
  std::optional<FixedMotionPathMaker> path;        // at the current state, with the target's motion
  std::optional<FixedMotionPathMaker> first_path;  // at the linearisation points, if they differ
  std::optional<CommutedBlur> commuted;            // if the host's image is itself blurred
  bool blurred = false;
  float huber_threshold = std::numeric_limits<float>::infinity();  // the target's
  float precision = 1.0F;                                          // the target's
  float gain = 1.0F;                                               // exp(a_target - a_host)
  float offset_host = 0.0F;                                        // b_host
  float offset_target = 0.0F;                                      // b_target
  Matrix8 J_host = Matrix8::Zero();  // d (target's states) / d (host's states) with equal effect on the residual
};

PairGeometry makePairGeometry(const KeyframeState& host, const KeyframeState& target, bool reblur_targets);

/// All pairs of the window; that of a host in a target is number host * keyframes + target.
std::vector<PairGeometry> makePairGeometries(const WindowState& state, bool reblur_targets);
/// Only those in which the points numbered `points` have residuals; the others have no images.
std::vector<PairGeometry> makePairGeometries(const WindowState& state, bool reblur_targets,
                                             const std::vector<int>& points);

/// Where the target sees a point of the host; nullopt if it is behind.
std::optional<Eigen::Vector2d> projectIntoTarget(const PairGeometry& pair, const Eigen::Vector2d& host_pixel,
                                                 double inverse_depth);

/// The path of a residual's pixels in the host at the current state, without the derivatives by the pose. False if
/// there is none.
bool makePath(const PairGeometry& pair, const Eigen::Vector2i& centre, const PointState& point, PatchPath& path);
/// The path with the derivatives that the normal equations use: at the linearisation points.
bool makeJacobianPath(const PairGeometry& pair, const Eigen::Vector2i& centre, const PointState& point,
                      PatchPath& path);
/// The same at the current state.
bool makeCurrentJacobianPath(const PairGeometry& pair, const Eigen::Vector2i& centre, const PointState& point,
                             PatchPath& path);

}  // namespace mba_vo
