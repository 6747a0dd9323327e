#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mba_vo/geometry/exposure_trajectory.h"

namespace mba_vo {

/// Where the camera was when the shutter opened and closed.
struct ExposurePoses {
  double exposure = 0.0;  // [s]
  SE3 T_world_start;
  SE3 T_world_end;
};

/// One line of a trajectory file.
struct PoseRecord {
  double time = 0.0;   // mid-exposure [s]
  SE3 T_world_camera;  // at mid-exposure
  std::optional<ExposurePoses> exposure;
  int map = 0;  // poses of different maps share no coordinate frame
};

/// Reads a trajectory, sorted by time. Two forms, told apart by the number of columns:
///   8: `t tx ty tz qx qy qz qw` (TUM form)
///  16: `t_mid exposure` + start pose + end pose; the mid pose is then the middle of the constant-velocity motion.
/// A line of the first form whose pose is all `nan` tells that it is unknown (TUM-mono), and is left out.
/// `#` begins a comment; the comment `# map N` assigns the poses after it to map N (0 before the first).
/// Throws std::runtime_error naming file and line for anything else, and for a file without poses.
std::vector<PoseRecord> readPoseFile(const std::string& file);
/// The same for a file that may have no pose: a run that never found one.
std::vector<PoseRecord> readPosesIfAny(const std::string& file);

}  // namespace mba_vo
