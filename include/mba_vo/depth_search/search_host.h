#pragma once

#include "mba_vo/geometry/exposure_trajectory.h"

namespace mba_vo {

/// What is known of a host keyframe beside its image.
struct SearchHost {
  BodyMotion motion;                   // of the camera, for a rolling shutter
  Vector6 image_xi = Vector6::Zero();  // motion that its image contains: zero if it is sharp
  double inverse_depth = 0.0;          // median of the points that are known [1/m]; 0: none is
};

/// The frame's trajectory with that part of its exposure whose blur the host's image lacks. On a steady turn both are
/// smeared alike: the motion pushes the blur of the one onto that of the other, and what is averaged again along the
/// frame's path has nothing left to be found by. Variances of blurs add up: along the frame's path, that of the host is
/// taken off.
ExposureTrajectory withoutBlurOf(const SearchHost& host, const ExposureTrajectory& T_host);

}  // namespace mba_vo
