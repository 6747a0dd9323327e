#pragma once

#include <cstddef>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mba_vo/mapping/loop_queue.h"
#include "mba_vo/mapping/mapper_config.h"
#include "mba_vo/pose_graph/loop_correction.h"
#include "mba_vo/relocalization/saved_map.h"
#include "mba_vo/trajectory/trajectory_store.h"

namespace mba_vo {

class LocalMap;

/// What there is to be known about a trajectory in the end.
struct SmoothedTrajectory {
  std::vector<TrajectoryEntry> entries;
  std::vector<LoopTrial> loops;                   // that were looked into, those that were rejected too
  TrajectoryStore::CorrectedKeyframes corrected;  // where loops put keyframes
};

/// Loops of all maps, and what follows from them: where the map is by now, and the trajectory in the end. Nothing of
/// this acts on the window: it goes on as it was, and all of it is moved.
class LoopClosing {
 public:
  explicit LoopClosing(const MapperConfig& config);

  /// Takes the keyframes that have left the window, and what has been found by now of those before. Returns what to
  /// tell: that a loop has moved the map, and by how much; else nothing.
  std::string follow(LocalMap& map, const TrajectoryStore& store);
  /// Takes the keyframes of an earlier run that `map` continues.
  void know(const SavedMap& earlier, MapId map);
  /// Nothing more will come of this window: takes all that it has. Another one begins with a keyframe that has left it:
  /// it is moved as that was.
  void changeWindow(const LocalMap& left, KeyframeId keyframe, const TrajectoryStore& store);
  /// The keyframes of the map are no more.
  void forgetMap();
  LoopCounts counts() const;

  /// By what the loops that are known move what the window of the present map has (Reference::T_corrected_map).
  const SE3& T_corrected_map() const { return T_corrected_map_; }
  /// Where they put the keyframes of all maps.
  TrajectoryStore::CorrectedKeyframes corrected(const TrajectoryStore& store) const;

  /// Waits for what has been found. `map`: the current one, or null, whose keyframes are looked for, too.
  SmoothedTrajectory smoothed(const TrajectoryStore& store, const LocalMap* map) const;

 private:
  /// The poses of a map by its loops, and by odometry when the graph was made.
  struct Correction {
    MapId map = 0;
    double depth = 1.0;  // LoopCloser::usualDepth
    CorrectedPoses keyframes;
    SE3 T_corrected_map;
  };
  std::optional<Correction> takeSolution();
  void solve(const LocalMap& map, const TrajectoryStore& store);
  std::string adopt(Correction correction, const LocalMap& map);

  bool deterministic_;                // what is found is waited for
  std::unique_ptr<LoopQueue> queue_;  // null: no loops are to be closed
  std::size_t solved_ = 0;            // loops, of all maps, that the last graph was made with
  std::future<Correction> solving_;
  std::map<MapId, Correction> corrections_;
  SE3 T_corrected_map_;  // of the present map
};

}  // namespace mba_vo
