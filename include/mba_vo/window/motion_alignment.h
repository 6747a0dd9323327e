#pragma once

#include <optional>
#include <vector>

#include "mba_vo/solver/levenberg_marquardt.h"
#include "mba_vo/window/photometric_residual.h"
#include "mba_vo/window/window_state.h"

namespace mba_vo {

/// Blur with which an error of the motion within the exposure does harm; it is more likely, too [px].
inline constexpr double kLongBlur = 15.0;

/// Aligns one image, as a target, with the points of a window that it sees, all else fixed: pose, brightness and the
/// motion within its exposure. That motion came from the poses of the frames around, which are poor on fast turns, and
/// a blurred image compared with a wrong blur gives a wrong pose. What those frames say of it is the prior. This is the
/// problem as `minimize` wants it.
class MotionAlignment {
 public:
  static constexpr int kStates = 14;  // right increment of the pose, a, b, xi

  /// A keyframe of the window, by its index, with the points that have a residual there. `state` and `options` must
  /// outlive the object.
  MotionAlignment(const WindowState& state, int target, const ResidualOptions& options);
  /// A frame that is no keyframe, with all points. `frame` must outlive the object, too.
  MotionAlignment(const WindowState& state, const KeyframeState& frame, const ResidualOptions& options);

  /// The image shows too few points to tell anything.
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
  MotionAlignment(const WindowState& state, const KeyframeState& target, std::vector<Patch> patches,
                  const ResidualOptions& options);
  static std::vector<Patch> patchesInto(const WindowState& state, int target);
  static std::vector<Patch> patchesOfAll(const WindowState& state);
  KeyframeState with(const KeyframeMotion& motion) const;
  /// Leaves out what cannot be seen at the beginning, or would be too much.
  void choosePatches();
  /// With the hosts of the patches, by their index.
  std::vector<PairGeometry> pairsWith(const KeyframeState& target) const;
  void addPatch(const Patch& patch, const PairGeometry& pair, const KeyframeState& target,
                NormalEquations<kStates>& equations) const;
  void addPrior(const KeyframeMotion& motion, NormalEquations<kStates>& equations) const;

  const WindowState& state_;
  const KeyframeState& target_;
  const ResidualOptions& options_;
  double focal_length_ = 1.0;          // [px]
  double median_inverse_depth_ = 1.0;  // [1/m]
  std::vector<Patch> patches_;
};

/// Aligns the newest keyframe, which must not host any points. Returns whether anything has changed. A sharp one is
/// left as it is.
bool alignNewest(WindowState& state, const ResidualOptions& options);

/// Aligns a frame that is no keyframe. nullopt if it is sharp, sees too few points, or nothing better is found.
std::optional<KeyframeMotion> alignFrame(const WindowState& state, const KeyframeState& frame,
                                         const ResidualOptions& options);

}  // namespace mba_vo
