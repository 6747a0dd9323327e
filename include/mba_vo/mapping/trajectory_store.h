#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "mba_vo/tracking/tracked_frame.h"

namespace mba_vo {

/// One row of the written trajectory: where a frame ended up after all optimisation so far.
struct TrajectoryEntry {
  std::uint64_t frame_sequence = 0;
  std::int64_t stamp_ns = 0;
  std::int64_t mid_exposure_ns = 0;
  MapId map_id = 0;
  ExposureTrajectory trajectory;  // relative to the map
};

/// Keeps every measured pose relative to its keyframe and the newest pose of every keyframe; composes them only when a
/// trajectory is asked for.
class TrajectoryStore {
 public:
  /// Stores or replaces the pose of a tracked frame; that of a keyframe stays.
  void addFrame(const TrackedFrame& tracked);
  /// The frame has become this keyframe: its pose is the keyframe's from now on, its motion what the tracker found.
  void makeKeyframe(const TrackedFrame& tracked, MapId map, KeyframeId keyframe);
  void setKeyframePose(MapId map, KeyframeId keyframe, const SE3& T_map_keyframe);
  /// Forgets the frames of a map that are relative to this or later keyframes.
  void forget(MapId map, KeyframeId from_keyframe);
  SE3 T_map_keyframe(MapId map, KeyframeId keyframe) const;

  /// All frames by time.
  std::vector<TrajectoryEntry> entries() const;

 private:
  struct StoredFrame {
    std::int64_t stamp_ns;
    std::int64_t mid_exposure_ns;
    MapId map_id;
    KeyframeId keyframe_id;
    ExposureTrajectory trajectory;  // relative to the keyframe
    bool is_keyframe = false;
  };
  std::map<std::uint64_t, StoredFrame> frames_;  // by sequence number
  std::map<std::pair<MapId, KeyframeId>, SE3> T_map_keyframe_;
};

}  // namespace mba_vo
