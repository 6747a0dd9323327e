#pragma once

#include <cstddef>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "mba_vo/mapping/local_map.h"
#include "mba_vo/mapping/mapper_config.h"
#include "mba_vo/pose_graph/loop_correction.h"
#include "mba_vo/pose_graph/loop_queue.h"
#include "mba_vo/pose_graph/map_joins.h"
#include "mba_vo/relocalization/saved_map.h"
#include "mba_vo/trajectory/trajectory_store.h"

namespace mba_vo {

/// What there is to be known about a trajectory in the end.
struct SmoothedTrajectory {
  std::vector<TrajectoryEntry> entries;
  std::vector<LoopTrial> loops;                   // that were looked into, those that were rejected too
  TrajectoryStore::CorrectedKeyframes corrected;  // where loops put keyframes
};

/// Loops within maps and between them, and what follows from them: where the map is by now, and the trajectory in the
/// end. Nothing of this acts on the window: it goes on as it was, and all of it is moved. A map that was lost is joined
/// to the present one as soon as both show one place: it is scaled, the present one keeps its unit and is moved.
class LoopClosing {
 public:
  explicit LoopClosing(const MapperConfig& config);

  /// Takes the keyframes that have left the window, and what has been found by now of those before. Returns what to
  /// tell: that a loop has moved the map, and by how much, or that maps were joined; else nothing.
  std::string follow(const LocalMap& map, const std::vector<LocalMap::Departed>& departed,
                     const TrajectoryStore& store);
  /// Takes the keyframes of an earlier run that `map` continues.
  void know(const SavedMap& earlier, MapId map);
  /// Nothing more will come of this window: takes all that it has. Another one begins with a keyframe that has left it:
  /// it is moved as that was.
  void changeWindow(const LocalMap& left, KeyframeId keyframe, const TrajectoryStore& store);
  /// The camera was lost for good: another map begins, which may be joined to this one by these keyframes.
  void leaveMap(const KeyframeArchive& keyframes);
  /// The map was wrong: nothing is joined to it.
  void giveUpMap(MapId map);
  /// Nothing that was seen counts any more.
  void forgetMaps();
  LoopCounts counts() const;

  /// By what the loops that are known move what the window of the present map has (Reference::T_corrected_map).
  const SE3& T_corrected_map() const { return T_corrected_map_; }
  /// Where they put the keyframes of the maps that they move.
  TrajectoryStore::CorrectedKeyframes corrected(const TrajectoryStore& store) const;
  /// All frames as the loops that are known have them. Maps that hang together are one: it has the id of the last.
  std::vector<TrajectoryEntry> trajectory(const TrajectoryStore& store) const;

  /// Waits for what has been found. `map`: the current one, or null, whose keyframes are looked for, too.
  SmoothedTrajectory smoothed(const TrajectoryStore& store, const LocalMap* map) const;

 private:
  /// The poses of maps that hang together by their loops. All are in the frame of the first and the unit of the last.
  struct Correction {
    std::set<MapId> maps;
    double depth = 1.0;  // LoopCloser::usualDepths of the last
    CorrectedPoses keyframes;
    SE3 T_corrected_map;  // of the last, by odometry when the graph was made
    int joins = 0;        // keyframes by which they hang together
    MapId last() const { return *maps.rbegin(); }
  };
  static Correction correct(const std::vector<OdometryMap>& maps, std::vector<LoopTrial>& loops);
  static std::vector<OdometryMap> mapsOf(const std::set<MapId>& ids, const TrajectoryStore& store,
                                         const std::map<MapId, double>& usual_depths);
  /// There is a map that was left, and it is not known well enough how this one stands to it.
  bool mayBeJoined(MapId map) const;
  std::optional<Correction> takeSolution();
  void solve(const LocalMap& map, const TrajectoryStore& store);
  std::string adopt(Correction correction, const LocalMap& map);
  std::string describeJoin(const Correction& correction) const;

  bool close_;          // loops within a map, too
  bool deterministic_;  // what is found is waited for
  std::unique_ptr<LoopQueue> queue_;
  std::size_t solved_ = 0;  // loops, of all maps, that the last graph was made with
  std::future<Correction> solving_;
  std::vector<Correction> corrections_;  // of maps that do not hang together
  SE3 T_corrected_map_;                  // of the present map
  std::set<MapId> left_;                 // maps that may be joined to the present one
};

}  // namespace mba_vo
