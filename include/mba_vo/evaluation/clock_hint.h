#pragma once

#include <string>
#include <vector>

#include "mba_vo/evaluation/pose_file.h"

namespace mba_vo {

/// A sentence with both time ranges and their difference if most of the estimate lies outside the time of the ground
/// truth, but would not if the first stamps were the same; empty if not. Both sorted by time.
std::string clockHint(const std::vector<PoseRecord>& groundtruth, const std::vector<PoseRecord>& estimate);

}  // namespace mba_vo
