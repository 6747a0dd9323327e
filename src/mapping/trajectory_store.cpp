#include "mba_vo/mapping/trajectory_store.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace mba_vo {
namespace {

template <typename Keyframes>
auto placeOf(Keyframes& keyframes, const std::pair<MapId, KeyframeId>& id) {
  return std::lower_bound(keyframes.begin(), keyframes.end(), id,
                          [](const auto& keyframe, const auto& wanted) { return keyframe.id < wanted; });
}

}  // namespace

TrajectoryStore::StoredFrame& TrajectoryStore::entryOf(std::uint64_t sequence) {
  const auto place = std::lower_bound(frames_.begin(), frames_.end(), sequence,
                                      [](const StoredFrame& frame, std::uint64_t s) { return frame.sequence < s; });
  if (place != frames_.end() && place->sequence == sequence) return *place;
  StoredFrame frame;
  frame.sequence = sequence;
  return *frames_.insert(place, frame);
}

void TrajectoryStore::addFrame(const TrackedFrame& tracked) {
  const Frame& frame = *tracked.frame;
  StoredFrame& stored = entryOf(frame.sequence);
  if (stored.is_keyframe) return;
  stored.stamp_ns = frame.stamp_ns;
  stored.mid_exposure_ns = frame.mid_exposure_ns;
  stored.map_id = tracked.reference.map_id;
  stored.keyframe_id = tracked.reference.keyframe_id;
  stored.T_keyframe_mid = StoredPose(tracked.trajectory.T_reference_mid);
  stored.exposure = tracked.trajectory.exposure;
  stored.velocity = tracked.trajectory.velocity.cast<float>();
  stored.degraded = tracked.status == TrackingStatus::kDegraded;
  stored.acceleration = tracked.trajectory.acceleration.cast<float>();
}

void TrajectoryStore::makeKeyframe(const TrackedFrame& tracked, MapId map, KeyframeId keyframe) {
  entryOf(tracked.frame->sequence).is_keyframe = false;
  addFrame(tracked);
  StoredFrame& stored = entryOf(tracked.frame->sequence);
  stored.map_id = map;
  stored.keyframe_id = keyframe;
  stored.T_keyframe_mid = StoredPose();
  stored.is_keyframe = true;
}

void TrajectoryStore::setKeyframePose(MapId map, KeyframeId keyframe, const SE3& T_map_keyframe) {
  const std::pair<MapId, KeyframeId> id(map, keyframe);
  const auto place = placeOf(keyframes_, id);
  if (place != keyframes_.end() && place->id == id) {
    place->T_map_keyframe = T_map_keyframe;
  } else {
    keyframes_.insert(place, {id, T_map_keyframe});
  }
}

void TrajectoryStore::forget(MapId map, KeyframeId from_keyframe) {
  const auto forgotten = [&](const StoredFrame& frame) {
    return frame.map_id == map && frame.keyframe_id >= from_keyframe;
  };
  frames_.erase(std::remove_if(frames_.begin(), frames_.end(), forgotten), frames_.end());
}

SE3 TrajectoryStore::T_map_keyframe(MapId map, KeyframeId keyframe) const {
  const std::pair<MapId, KeyframeId> id(map, keyframe);
  const auto place = placeOf(keyframes_, id);
  if (place == keyframes_.end() || place->id != id) {
    throw std::out_of_range("map " + std::to_string(map) + " has no keyframe " + std::to_string(keyframe));
  }
  return place->T_map_keyframe;
}

std::vector<TrajectoryEntry> TrajectoryStore::entries() const {
  std::vector<TrajectoryEntry> entries;
  entries.reserve(frames_.size());
  for (const StoredFrame& frame : frames_) {
    const SE3 T_map_mid = T_map_keyframe(frame.map_id, frame.keyframe_id) * frame.T_keyframe_mid.pose();
    const ExposureTrajectory in_map{T_map_mid, frame.velocity.cast<double>(), frame.exposure,
                                    frame.acceleration.cast<double>()};
    entries.push_back({frame.sequence, frame.stamp_ns, frame.mid_exposure_ns, frame.map_id, in_map, frame.degraded});
  }
  std::sort(entries.begin(), entries.end(),
            [](const auto& l, const auto& r) { return l.mid_exposure_ns < r.mid_exposure_ns; });
  return entries;
}

}  // namespace mba_vo
