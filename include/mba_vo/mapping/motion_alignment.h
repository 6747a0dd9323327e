#pragma once

#include <vector>

#include "mba_vo/mapping/photometric_residual.h"
#include "mba_vo/mapping/window_state.h"
#include "mba_vo/solver/levenberg_marquardt.h"

namespace mba_vo {

/// What MotionAlignment estimates of a keyframe.
struct KeyframeMotion {
  SE3 T_map_keyframe;
  AffineBrightness brightness;
  Vector6 xi = Vector6::Zero();  // motion within its exposure, camera frame [m, rad]
};

/// Aligns one keyframe of a window, as a target, with the points that it sees, all else fixed: pose, brightness and the
/// motion within its exposure. That motion came from the poses of the frames around, which are poor on fast turns, and
/// a blurred image compared with a wrong blur gives a wrong pose. What those frames say of it is the prior. This is the
/// problem as `minimize` wants it.
class MotionAlignment {
 public:
  static constexpr int kStates = 14;  // right increment of the pose, a, b, xi

  /// `target`: index of the keyframe. `state` and `options` must outlive the object.
  MotionAlignment(const WindowState& state, int target, const ResidualOptions& options);

  /// The keyframe sees too few points to tell anything.
  bool isStarving() const;
  KeyframeMotion initial() const;

  NormalEquations<kStates> linearize(const KeyframeMotion& motion) const;
  /// New pixels for the patches that moved far. True if there are any.
  bool refresh(const KeyframeMotion& motion);
  static KeyframeMotion plus(const KeyframeMotion& motion, const Eigen::Matrix<double, kStates, 1>& step);
  /// By which the pose, or xi, moves the image [px].
  double stepSize(const Eigen::Matrix<double, kStates, 1>& step) const;

 private:
  struct Patch {
    const PointState* point;
    PatchResidual residual;  // its energy is that at the beginning, truncated
  };
  KeyframeState with(const KeyframeMotion& motion) const;
  /// Leaves out what cannot be seen at the beginning, or would be too much.
  void choosePatches();
  /// With the hosts of the patches, by their index.
  std::vector<PairGeometry> pairsWith(const KeyframeState& target) const;
  void addPatch(const Patch& patch, const PairGeometry& pair, const KeyframeState& target,
                NormalEquations<kStates>& equations) const;
  void addPrior(const KeyframeMotion& motion, NormalEquations<kStates>& equations) const;

  const WindowState& state_;
  int target_;
  const ResidualOptions& options_;
  double focal_length_ = 1.0;          // [px]
  double median_inverse_depth_ = 1.0;  // [1/m]
  std::vector<Patch> patches_;
};

/// Aligns the newest keyframe, which must not host any points. Returns whether anything has changed. A sharp one is
/// left as it is.
bool alignNewest(WindowState& state, const ResidualOptions& options);

}  // namespace mba_vo
