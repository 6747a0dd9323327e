#include "mba_vo/trajectory/trajectory_store.h"

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

TrajectoryStore::StoredPose::StoredPose(const SE3& T)
    : rotation(T.rotation().cast<float>()), translation(T.translation().cast<float>()) {}

SE3 TrajectoryStore::StoredPose::pose() const { return {rotation.cast<double>(), translation.cast<double>()}; }

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
    place->T_base_keyframe = T_map_keyframe;
    place->base.reset();
  } else {
    keyframes_.insert(place, {id, T_map_keyframe, std::nullopt, std::nullopt});
  }
}

void TrajectoryStore::attachKeyframe(MapId map, KeyframeId keyframe, KeyframeId base) {
  if (base <= keyframe) {
    throw std::invalid_argument("keyframe " + std::to_string(keyframe) + " cannot be attached to keyframe " +
                                std::to_string(base) + ", which is not newer");
  }
  const SE3 T_base_keyframe = T_map_keyframe(map, base).inverse() * T_map_keyframe(map, keyframe);
  const auto place = placeOf(keyframes_, {map, keyframe});
  place->T_base_keyframe = T_base_keyframe;
  place->base = base;
}

void TrajectoryStore::continueFrom(MapId map, KeyframeId keyframe, KeyframeId older) {
  if (older >= keyframe) {
    throw std::invalid_argument("keyframe " + std::to_string(keyframe) + " cannot continue keyframe " +
                                std::to_string(older) + ", which is not older");
  }
  entryOf(map, older);
  entryOf(map, keyframe);
  placeOf(keyframes_, {map, keyframe})->continues = older;
}

void TrajectoryStore::forget(MapId map, KeyframeId from_keyframe) {
  const auto forgotten = [&](const StoredFrame& frame) {
    return frame.map_id == map && frame.keyframe_id >= from_keyframe;
  };
  frames_.erase(std::remove_if(frames_.begin(), frames_.end(), forgotten), frames_.end());
}

const TrajectoryStore::StoredKeyframe& TrajectoryStore::entryOf(MapId map, KeyframeId keyframe) const {
  const std::pair<MapId, KeyframeId> id(map, keyframe);
  const auto place = placeOf(keyframes_, id);
  if (place == keyframes_.end() || place->id != id) {
    throw std::out_of_range("map " + std::to_string(map) + " has no keyframe " + std::to_string(keyframe));
  }
  return *place;
}

SE3 TrajectoryStore::T_map_keyframe(MapId map, KeyframeId keyframe) const {
  const StoredKeyframe* stored = &entryOf(map, keyframe);
  SE3 pose = stored->T_base_keyframe;
  while (stored->base) {
    stored = &entryOf(map, *stored->base);
    pose = stored->T_base_keyframe * pose;
  }
  return pose;
}

/// From the newest to the oldest: what a keyframe is relative to is newer.
std::vector<SE3> TrajectoryStore::keyframePoses() const {
  std::vector<SE3> poses(keyframes_.size());
  for (std::size_t i = keyframes_.size(); i-- > 0;) {
    const StoredKeyframe& keyframe = keyframes_[i];
    poses[i] = keyframe.T_base_keyframe;
    if (!keyframe.base) continue;
    const auto base = placeOf(keyframes_, {keyframe.id.first, *keyframe.base});
    poses[i] = poses[static_cast<std::size_t>(base - keyframes_.begin())] * poses[i];
  }
  return poses;
}

std::vector<TrajectoryStore::KeyframePlace> TrajectoryStore::keyframes(MapId map) const {
  const std::vector<SE3> poses = keyframePoses();
  std::vector<KeyframePlace> places;
  for (std::size_t i = 0; i < keyframes_.size(); ++i) {
    const StoredKeyframe& keyframe = keyframes_[i];
    if (keyframe.id.first == map) places.push_back({keyframe.id.second, poses[i], keyframe.base, keyframe.continues});
  }
  return places;
}

std::vector<TrajectoryEntry> TrajectoryStore::entries(const CorrectedKeyframes& corrected) const {
  const std::vector<SE3> keyframe_poses = keyframePoses();
  std::vector<TrajectoryEntry> entries;
  entries.reserve(frames_.size());
  for (const StoredFrame& frame : frames_) {
    const auto keyframe = &entryOf(frame.map_id, frame.keyframe_id) - keyframes_.data();
    ExposureTrajectory in_map{keyframe_poses[static_cast<std::size_t>(keyframe)] * frame.T_keyframe_mid.pose(),
                              frame.velocity.cast<double>(), frame.exposure, frame.acceleration.cast<double>()};
    if (const auto found = corrected.find({frame.map_id, frame.keyframe_id}); found != corrected.end()) {
      const Sim3 S_map_mid = found->second * Sim3(frame.T_keyframe_mid.pose());
      in_map.T_reference_mid = S_map_mid.rigid();
      in_map.velocity.head<3>() *= S_map_mid.scale();
      in_map.acceleration.head<3>() *= S_map_mid.scale();
    }
    entries.push_back({frame.sequence, frame.stamp_ns, frame.mid_exposure_ns, frame.map_id, in_map, frame.degraded});
  }
  std::sort(entries.begin(), entries.end(), [](const auto& l, const auto& r) {
    return std::pair(l.map_id, l.mid_exposure_ns) < std::pair(r.map_id, r.mid_exposure_ns);
  });
  return entries;
}

}  // namespace mba_vo
