#pragma once

#include <string>
#include <vector>

#include "mba_vo/evaluation/pose_file.h"

namespace mba_vo {

/// What there is to say about stamps that do not fit together: both time ranges and their difference if most of the
/// estimate lies outside the time of the ground truth, but would not if the first stamps were the same; and the offset
/// by which the angular speeds agree, where that is evident. Empty if there is nothing. Both sorted by time.
std::string clockHint(const std::vector<PoseRecord>& groundtruth, const std::vector<PoseRecord>& estimate);

}  // namespace mba_vo
