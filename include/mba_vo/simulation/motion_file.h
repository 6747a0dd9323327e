#pragma once

#include <string>
#include <vector>

#include "mba_vo/geometry/se3.h"

namespace mba_vo {

struct TimedPose {
  double t = 0.0;  // [s]
  SE3 T_world_camera;
};

/// Reads a recorded motion: lines `t[s] tx ty tz[m] qx qy qz qw`, camera (optical frame) to world, z up, `#` begins a
/// comment. Throws std::runtime_error naming file, line and what is wrong: numbers that are missing or not finite,
/// times that do not grow or leave more than 0.2 s out, quaternions that are no rotations or turn more than 45 degrees
/// from line to line, fewer than four poses.
std::vector<TimedPose> readMotionFile(const std::string& file);

}  // namespace mba_vo
