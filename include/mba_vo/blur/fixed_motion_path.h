#pragma once

#include "mba_vo/blur/patch_path.h"
#include "mba_vo/blur/row_motion.h"

namespace mba_vo {

/// Makes the same paths as PatchPathMaker where the motion within the exposure is given and not estimated. With no
/// derivatives for it, the others follow from the plane at a fraction of the cost.
class FixedMotionPathMaker {
 public:
  FixedMotionPathMaker(const PinholeCamera& reference_camera, const PinholeCamera& camera,
                       const ExposureTrajectory& trajectory, const RowMotion& rows = {});

  /// As PatchPathMaker::make, but leaves J_xi as it is.
  bool make(const Eigen::Vector2d& pixel, double inverse_depth, PatchPath& path, double reference_row = 0.0) const;
  /// The same without J_pose, for half the time.
  bool makeWithoutPose(const Eigen::Vector2d& pixel, double inverse_depth, PatchPath& path,
                       double reference_row = 0.0) const;

 private:
  struct Hit;
  struct Moments {
    RigidMotion start, mid, end;
  };
  /// Those of the camera's row `row` relative to where the reference was at its `reference_row`.
  Moments momentsAt(double row, double reference_row) const;
  /// What an increment of the pose moves: mid-exposure, but for the time of the camera's row.
  RigidMotion carrierAt(double reference_row) const;
  Moments momentsAround(const RigidMotion& mid) const;
  bool hit(const RigidMotion& moment, const Eigen::Vector3d& ray, double inverse_depth, Hit& hit) const;
  Matrix26 poseJacobian(const RigidMotion& carrier, const Hit& hit, double inverse_depth) const;
  /// `carrier`: nullptr if the derivatives by the pose are not wanted.
  bool makePath(const Moments& moments, const RigidMotion* carrier, const Eigen::Vector2d& pixel, double inverse_depth,
                PatchPath& path) const;

  PinholeCamera reference_camera_;
  PinholeCamera camera_;
  bool moving_;
  bool rolling_;
  MovingPose to_reference_row_;    // of the reference: its middle row relative to another
  MovingPose T_reference_camera_;  // of mid-exposure in the camera's rows
  RigidMotion to_start_, to_end_;  // of the exposure, from its middle
  Moments moments_;                // of the middle rows
};

}  // namespace mba_vo
