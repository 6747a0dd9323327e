#pragma once

#include <memory>
#include <vector>

#include "mba_vo/mapping/loop_queue.h"
#include "mba_vo/mapping/mapper_config.h"
#include "mba_vo/pose_graph/loop_correction.h"
#include "mba_vo/trajectory/trajectory_store.h"

namespace mba_vo {

class LocalMap;

/// What there is to be known about a trajectory in the end.
struct SmoothedTrajectory {
  std::vector<TrajectoryEntry> entries;
  std::vector<LoopTrial> loops;                   // that were looked into, those that were rejected too
  TrajectoryStore::CorrectedKeyframes corrected;  // where loops put keyframes
};

/// Loops of all maps, and what follows from them for the trajectory. Nothing of this acts on the window.
class LoopClosing {
 public:
  explicit LoopClosing(const MapperConfig& config);

  /// Takes the keyframes that have left the window.
  void follow(LocalMap& map);
  /// Nothing more will come of this window: takes all that it has.
  void close(const LocalMap& map);
  /// The keyframes of the map are no more.
  void forgetMap();
  LoopCounts counts() const;

  /// Waits for what has been found. `map`: the current one, or null, whose keyframes are looked for, too.
  SmoothedTrajectory smoothed(const TrajectoryStore& store, const LocalMap* map) const;

 private:
  std::unique_ptr<LoopQueue> queue_;  // null: no loops are to be closed
};

}  // namespace mba_vo
