#pragma once

#include <map>
#include <set>
#include <utility>
#include <vector>

#include "mba_vo/pose_graph/loop_closer.h"

namespace mba_vo {

/// Which maps hang together, by keyframes of both that show one place.
class MapJoins {
 public:
  explicit MapJoins(const std::vector<LoopTrial>& trials);

  /// The maps that hang together with this one, itself too.
  std::set<MapId> joinedWith(MapId map) const;
  /// It is known well how these stand to each other: there is no need to look for more.
  bool areSettled(MapId a, MapId b) const;

 private:
  std::map<MapId, std::map<MapId, int>> joins_;  // keyframes of one that show what the other has, both ways
};

}  // namespace mba_vo
