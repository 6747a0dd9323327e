#pragma once

#include <optional>
#include <vector>

#include "mba_vo/evaluation/pose_file.h"

namespace mba_vo {

/// True pose at `time` [s] between two poses at most 0.1 s apart, along the constant-velocity motion that joins them;
/// nullopt elsewhere. `groundtruth` is sorted by time.
std::optional<SE3> truePoseAt(const std::vector<PoseRecord>& groundtruth, double time);

/// When the camera had first moved by `min_distance` [m] since `begin` [s]: time of a true pose; nullopt if never.
/// Before the first true pose the camera is taken to stand still.
std::optional<double> timeOfDistance(const std::vector<PoseRecord>& groundtruth, double begin, double min_distance);

}  // namespace mba_vo
