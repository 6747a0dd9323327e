#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "mba_vo/geometry/sim3.h"
#include "mba_vo/tracking/tracked_frame.h"

namespace mba_vo {

/// One row of the written trajectory: where a frame ended up after all optimisation so far.
struct TrajectoryEntry {
  std::uint64_t frame_sequence = 0;
  std::int64_t stamp_ns = 0;
  std::int64_t mid_exposure_ns = 0;
  MapId map_id = 0;
  ExposureTrajectory trajectory;  // relative to the map
  bool degraded = false;          // when it was measured
};

/// Keeps every measured pose relative to its keyframe and the newest pose of every keyframe; composes them only when a
/// trajectory is asked for. A keyframe that has left the window is kept relative to one that has not: where the two are
/// from each other is known far better than where the window as a whole is, which goes on changing.
class TrajectoryStore {
 public:
  /// Stores or replaces the pose of a tracked frame; that of a keyframe stays.
  void addFrame(const TrackedFrame& tracked);
  /// The frame has become this keyframe: its pose is the keyframe's from now on, its motion what the tracker found.
  void makeKeyframe(const TrackedFrame& tracked, MapId map, KeyframeId keyframe);
  void setKeyframePose(MapId map, KeyframeId keyframe, const SE3& T_map_keyframe);
  /// From now on the keyframe is where it is relative to a newer one, `base`, wherever that will be.
  void attachKeyframe(MapId map, KeyframeId keyframe, KeyframeId base);
  /// After a loss the map goes on with this keyframe, which is made of the same image as an older one: odometry has
  /// not led from one to the next. Throws std::invalid_argument if that is not older, std::out_of_range if there is
  /// none.
  void continueFrom(MapId map, KeyframeId keyframe, KeyframeId older);
  /// Forgets the frames of a map that are relative to this or later keyframes.
  void forget(MapId map, KeyframeId from_keyframe);
  SE3 T_map_keyframe(MapId map, KeyframeId keyframe) const;

  struct KeyframePlace {
    KeyframeId keyframe = 0;
    SE3 T_map_keyframe;
    std::optional<KeyframeId> base;       // that it is attached to
    std::optional<KeyframeId> continues;  // the older one that shows the same image
  };
  /// Of a map, by id.
  std::vector<KeyframePlace> keyframes(MapId map) const;

  /// Where keyframes are, and how large what is relative to them, by what is not known here.
  using CorrectedKeyframes = std::map<std::pair<MapId, KeyframeId>, Sim3>;
  /// All frames, map by map, those of a map by time: a clock that begins anew must not mix maps.
  std::vector<TrajectoryEntry> entries(const CorrectedKeyframes& corrected = {}) const;

 private:
  /// In single precision, as hours of it have to fit, and relative to the keyframe nothing is far away.
  struct StoredPose {
    Eigen::Quaternionf rotation = Eigen::Quaternionf::Identity();
    Eigen::Vector3f translation = Eigen::Vector3f::Zero();  // [m]

    StoredPose() = default;
    explicit StoredPose(const SE3& T);
    SE3 pose() const;
  };
  struct StoredFrame {
    std::uint64_t sequence = 0;
    std::int64_t stamp_ns = 0;
    std::int64_t mid_exposure_ns = 0;
    MapId map_id = 0;
    KeyframeId keyframe_id = 0;
    StoredPose T_keyframe_mid;
    double exposure = 0.0;                                                         // [s]
    Eigen::Matrix<float, 6, 1> velocity = Eigen::Matrix<float, 6, 1>::Zero();      // [m/s, rad/s]
    Eigen::Matrix<float, 6, 1> acceleration = Eigen::Matrix<float, 6, 1>::Zero();  // [m/s^2, rad/s^2]
    bool is_keyframe = false;
    bool degraded = false;
  };
  struct StoredKeyframe {
    std::pair<MapId, KeyframeId> id;
    SE3 T_base_keyframe;
    std::optional<KeyframeId> base;       // nullopt: the map
    std::optional<KeyframeId> continues;  // KeyframePlace::continues
  };

  /// The entry of this frame; a new one if there was none.
  StoredFrame& entryOf(std::uint64_t sequence);
  const StoredKeyframe& entryOf(MapId map, KeyframeId keyframe) const;
  /// In the order of keyframes_.
  std::vector<SE3> keyframePoses() const;

  // In blocks, not piece by piece: what stays must not lie scattered between images that go.
  std::vector<StoredFrame> frames_;        // by sequence number
  std::vector<StoredKeyframe> keyframes_;  // by id
};

}  // namespace mba_vo
