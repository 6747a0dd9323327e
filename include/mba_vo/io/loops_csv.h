#pragma once

#include <ostream>
#include <vector>

#include "mba_vo/pose_graph/loop_closer.h"

namespace mba_vo {

/// loops.csv: one row per pair of keyframes that look alike; why it was rejected, or how the two stand to each other.
void writeLoops(const std::vector<LoopTrial>& loops, std::ostream& out);

}  // namespace mba_vo
