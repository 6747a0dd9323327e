#pragma once

#include <cstddef>
#include <vector>

#include "mba_vo/evaluation/pose_file.h"

namespace mba_vo {

/// Indices of a ground-truth pose and of the estimate for the same instant.
struct Association {
  std::size_t groundtruth = 0;
  std::size_t estimate = 0;
};

/// Pairs poses by time, one to one, closest pairs first, at most `max_difference` [s] apart. Both sorted by time;
/// the result is sorted by time too.
std::vector<Association> associateByTime(const std::vector<PoseRecord>& groundtruth,
                                         const std::vector<PoseRecord>& estimate, double max_difference);

/// The poses of the map with the most poses (the lowest id on a tie).
std::vector<PoseRecord> posesOfLargestMap(const std::vector<PoseRecord>& poses);
/// Number of different maps.
std::size_t countMaps(const std::vector<PoseRecord>& poses);

}  // namespace mba_vo
