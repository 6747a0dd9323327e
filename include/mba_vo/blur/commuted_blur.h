#pragma once

#include "mba_vo/blur/fixed_motion_path.h"
#include "mba_vo/blur/reblur.h"

namespace mba_vo {

/// What to do about a reference that is itself blurred. With a sharp scene S, a reference R = k_r * S and a frame B =
/// k_t * S (k: blur along a path, * locally a convolution), re-blurring R along the frame's path gives k_t * k_r * S.
/// The frame looks the same once it is blurred along the reference's path, k_r * B, because the two blurs commute. So
/// neither image has to be deblurred to be compared.
class CommutedBlur {
 public:
  /// `reference_camera` and `frame_camera` on the level in use; `reference_xi`: motion blur left in the reference.
  CommutedBlur(const PinholeCamera& reference_camera, const PinholeCamera& frame_camera, const SE3& T_reference_mid,
               const Vector6& reference_xi);

  /// Intensities of the patch around the integer pixel `centre` of the frame, blurred along the path that the
  /// reference's blur takes there; the plain intensities if the reference is sharp. NaN where invalid.
  void read(const ImageLevel& frame, const Eigen::Vector2d& centre, double inverse_depth, const PatchPattern& pattern,
            float sample_spacing_px, int max_samples, std::array<float, kMaxPatchPixels>& intensity,
            const Eigen::Vector2d& slope = Eigen::Vector2d::Zero()) const;

 private:
  bool referencePath(const Eigen::Vector2d& centre, double inverse_depth, const Eigen::Vector2d& slope,
                     PatchPath& path) const;

  bool blurred_;
  FixedMotionPathMaker to_reference_;
  FixedMotionPathMaker within_reference_;
};

}  // namespace mba_vo
