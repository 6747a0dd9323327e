#pragma once

#include "mba_vo/blur/patch_path.h"

namespace mba_vo {

/// Makes the same paths as PatchPathMaker where the motion within the exposure is given and not estimated. With no
/// derivatives for it, the others follow from the plane at a fraction of the cost.
class FixedMotionPathMaker {
 public:
  FixedMotionPathMaker(const PinholeCamera& reference_camera, const PinholeCamera& camera,
                       const ExposureTrajectory& trajectory);

  /// As PatchPathMaker::make, but leaves J_xi as it is.
  bool make(const Eigen::Vector2d& pixel, double inverse_depth, PatchPath& path) const;
  /// The same without J_pose, for half the time.
  bool makeWithoutPose(const Eigen::Vector2d& pixel, double inverse_depth, PatchPath& path) const;

 private:
  struct Moment {
    Eigen::Matrix3d R;
    Eigen::Vector3d p;
  };
  struct Hit;
  bool hit(const Moment& moment, const Eigen::Vector3d& ray, double inverse_depth, Hit& hit) const;
  Matrix26 poseJacobian(const Hit& hit, double inverse_depth) const;
  template <bool WithPose>
  bool makePath(const Eigen::Vector2d& pixel, double inverse_depth, PatchPath& path) const;

  PinholeCamera reference_camera_;
  PinholeCamera camera_;
  bool moving_;
  Moment start_, mid_, end_;
};

}  // namespace mba_vo
