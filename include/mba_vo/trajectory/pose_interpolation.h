#pragma once

#include <cstdint>

#include "mba_vo/geometry/se3.h"

namespace mba_vo {

/// A camera at one moment of its way.
struct StampedPose {
  std::int64_t mid_exposure_ns = 0;
  SE3 T_map_camera;
  Vector6 velocity = Vector6::Zero();  // [m/s, rad/s, body frame]
};

/// The camera at a time between two stamped poses. Exact for a constant acceleration that takes the one's velocity to
/// the other's, up to what turns of a few degrees between them make of it.
StampedPose interpolatePose(const StampedPose& before, const StampedPose& after, std::int64_t mid_exposure_ns);

/// The velocity of the one in the middle by the poses of three: that of a constant acceleration.
Vector6 velocityByPoses(const StampedPose& before, const StampedPose& at, const StampedPose& after);

/// By how many standard deviations of their difference two measurements of a pose differ, squared; six for those that
/// are as good as they are said to be. Arguments as of fusedPose.
double squaredMahalanobisDistance(const SE3& T, const Matrix6& covariance, const SE3& T_other, const Vector6& sigma);

/// The mean of two measurements of a pose, weighed by what is known of each, to first order in their difference.
/// `covariance`: of the right increment of T; `sigma`: standard deviations of that of T_other.
SE3 fusedPose(const SE3& T, const Matrix6& covariance, const SE3& T_other, const Vector6& sigma);

}  // namespace mba_vo
