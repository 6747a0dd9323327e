#pragma once

#include <optional>
#include <vector>

#include "mba_vo/evaluation/pose_file.h"

namespace mba_vo {

/// How much later the stamps of the ground truth are than those of the estimate [s], by the angular speeds of the two,
/// which need no alignment. Looked for within 10 s of `guess` [s]. nullopt where they do not tell: too little motion,
/// motion that repeats itself, or speeds that agree no better than they do now, with `guess` = 0. Both sorted by time.
std::optional<double> findClockOffset(const std::vector<PoseRecord>& groundtruth,
                                      const std::vector<PoseRecord>& estimate, double guess);

}  // namespace mba_vo
