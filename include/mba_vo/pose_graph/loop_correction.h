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

/// A map as the odometry knows it.
struct OdometryMap {
  MapId id = 0;
  double usual_depth = 1.0;                 // of what keyframes see, in the unit of the map
  std::vector<OdometryKeyframe> keyframes;  // by id
};

/// Where the loops put the keyframes of a map, or of maps that hang together. The first stays where it is, the last
/// keeps its size: all are in the frame of the first map and in the unit of the last. Empty if there are no loops.
using CorrectedPoses = std::map<KeyframeId, Sim3>;  // S_map_keyframe

/// `maps`: by id; each after the first shows, by the loops, what an earlier or later one has. Ids of keyframes grow
/// from map to map. `loops`: between keyframes of these maps; they get their weights, and those that the others
/// contradict are rejected.
CorrectedPoses correctByLoops(const std::vector<OdometryMap>& maps, const std::vector<LoopTrial*>& loops);

}  // namespace mba_vo
