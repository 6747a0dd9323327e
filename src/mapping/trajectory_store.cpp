#include "mba_vo/mapping/trajectory_store.h"

#include <algorithm>

namespace mba_vo {

void TrajectoryStore::addFrame(const TrackedFrame& tracked) {
  const Frame& frame = *tracked.frame;
  StoredFrame& stored = frames_[frame.sequence];
  if (stored.is_keyframe) return;
  stored = {frame.stamp_ns, frame.mid_exposure_ns, tracked.reference.map_id, tracked.reference.keyframe_id,
            tracked.trajectory};
}

void TrajectoryStore::makeKeyframe(const TrackedFrame& tracked, MapId map, KeyframeId keyframe) {
  const Frame& frame = *tracked.frame;
  frames_[frame.sequence] = {frame.stamp_ns, frame.mid_exposure_ns, map, keyframe, tracked.trajectory, true};
  frames_[frame.sequence].trajectory.T_reference_mid = SE3();
}

void TrajectoryStore::setKeyframePose(MapId map, KeyframeId keyframe, const SE3& T_map_keyframe) {
  T_map_keyframe_[{map, keyframe}] = T_map_keyframe;
}

void TrajectoryStore::forget(MapId map, KeyframeId from_keyframe) {
  for (auto frame = frames_.begin(); frame != frames_.end();) {
    const bool forgotten = frame->second.map_id == map && frame->second.keyframe_id >= from_keyframe;
    frame = forgotten ? frames_.erase(frame) : std::next(frame);
  }
}

SE3 TrajectoryStore::T_map_keyframe(MapId map, KeyframeId keyframe) const {
  return T_map_keyframe_.at({map, keyframe});
}

std::vector<TrajectoryEntry> TrajectoryStore::entries() const {
  std::vector<TrajectoryEntry> entries;
  entries.reserve(frames_.size());
  for (const auto& [sequence, frame] : frames_) {
    ExposureTrajectory in_map = frame.trajectory;
    in_map.T_reference_mid = T_map_keyframe_.at({frame.map_id, frame.keyframe_id}) * in_map.T_reference_mid;
    entries.push_back({sequence, frame.stamp_ns, frame.mid_exposure_ns, frame.map_id, in_map});
  }
  std::sort(entries.begin(), entries.end(),
            [](const auto& l, const auto& r) { return l.mid_exposure_ns < r.mid_exposure_ns; });
  return entries;
}

}  // namespace mba_vo
