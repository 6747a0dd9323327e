#pragma once

#include <map>
#include <optional>
#include <vector>

#include "mba_vo/pose_graph/loop_closer.h"

namespace mba_vo {

/// A keyframe as the odometry knows it.
struct OdometryKeyframe {
  KeyframeId id = 0;
  SE3 T_map_keyframe;
  /// The newer one that it is known relative to since it left the window; none: the next one in time.
  std::optional<KeyframeId> base;
  /// After a loss, the older one that shows the same image: odometry has not led here.
  std::optional<KeyframeId> continues;
};

/// Where the loops put the keyframes of a map. The first stays where it is, the last keeps its size. Empty if there are
/// no loops.
using CorrectedPoses = std::map<KeyframeId, Sim3>;  // S_map_keyframe

/// `keyframes`: of one map, by id. `loops`: of that map; they get their weights, and those that the others contradict
/// are rejected. `depth`: what keyframes usually see lies at, in the unit of the map.
CorrectedPoses correctByLoops(const std::vector<OdometryKeyframe>& keyframes, const std::vector<LoopTrial*>& loops,
                              double depth);

}  // namespace mba_vo
