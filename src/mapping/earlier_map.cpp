#include "mapper_impl.h"

#include <stdexcept>
#include <string>
#include <utility>

namespace mba_vo {
namespace {

constexpr double kLongestSearch = 10.0;  // [s] with images that show something, then a new map begins

std::string sizeOf(const PinholeCamera& camera) {
  return std::to_string(camera.width) + "x" + std::to_string(camera.height);
}

}  // namespace

void Mapper::Impl::beginIn(const SavedMap& map) {
  if (map.keyframes.empty()) throw std::invalid_argument("a map without keyframes: the camera cannot be found in it");
  earlier_.reset();
  reset();
  earlier_ = map;
  lookInEarlierMap();
}

/// There is no window: the camera is looked for in what is known of the map.
void Mapper::Impl::lookInEarlierMap() {
  change(MappingEvent::kMapLoaded);
  for (const ArchivedKeyframe& keyframe : earlier_->keyframes) recovery_.archive().add(keyframe);
}

MapperOutput Mapper::Impl::locate(const TrackedFrame& frame) {
  MapperOutput output;
  if (isKnownWithoutMap(*frame.frame)) return output;
  const PinholeCamera& of_map = earlier_->keyframes.front().camera;
  const PinholeCamera& camera = frame.frame->pyramid.level(0).camera;
  if (!canBeOfOneCamera(of_map, camera)) {
    return notFoundInEarlierMap("the map that was loaded is of images of " + sizeOf(of_map) + " pixels, these have " +
                                sizeOf(camera));
  }
  if (!calibration_) beginCalibration(frame.frame->correction);
  recovery_.lose(frame);
  output.searched = true;
  if (const auto found = recovery_.search(frame, earlier_->usual_error)) return goOnFrom(*found, std::move(output));
  if (recovery_.lostSeconds() >= kLongestSearch) {
    MapperOutput without = notFoundInEarlierMap("the camera was not found in the map that was loaded");
    without.searched = true;
    return without;
  }
  output.message = "the camera is looked for in the map that was loaded, " +
                   std::to_string(earlier_->keyframes.size()) + " keyframes";
  return output;
}

/// A new map begins, if anything but the earlier one will do.
MapperOutput Mapper::Impl::notFoundInEarlierMap(const std::string& reason) {
  MapperOutput output;
  output.message = reason + (config_.localize_only ? ": it is looked for on" : ": a new map begins");
  if (config_.localize_only) return output;
  output.is_news = true;
  change(MappingEvent::kNotFound);
  earlier_.reset();
  recovery_.reset();
  return output;
}

/// Each time the camera is found in it, it is another map with numbers of its own, in the same frame.
LocalMap::Identity Mapper::Impl::identityOfEarlierMap() {
  const MapId id = next_map_id_++;
  loops_.know(*earlier_, id);
  for (const ArchivedKeyframe& keyframe : earlier_->keyframes) {
    store_.setKeyframePose(id, keyframe.reference.id.keyframe_id, keyframe.reference.T_map_reference);
  }
  return {id, earlier_->metric, earlier_->nextKeyframe(),
          displayPoints(*earlier_, id, static_cast<std::size_t>(config_.max_display_points))};
}

std::optional<SavedMap> Mapper::Impl::savedMap() const {
  if (!map_ || keepsEarlierMap()) return earlier_;
  return mapAsCorrected(loops_.smoothed(store_, map_.get()).corrected);
}

std::optional<SavedMap> Mapper::Impl::mapAsCorrected(const TrajectoryStore::CorrectedKeyframes& corrected) const {
  const std::map<KeyframeId, ArchivedKeyframe>& archived = recovery_.archive().keyframes();
  if (archived.empty()) return std::nullopt;
  std::vector<Sim3> poses;
  for (const auto& [id, kept] : archived) {
    const auto by_loops = corrected.find({map_->id(), id});
    poses.push_back(by_loops == corrected.end() ? Sim3(store_.T_map_keyframe(map_->id(), id)) : by_loops->second);
  }
  if (earlier_) keepUnit(poses);
  SavedMap map;
  map.metric = map_->isMetric();
  map.usual_error = health_.usualFrameError();
  auto pose = poses.begin();
  for (const auto& [id, kept] : archived) {
    map.keyframes.push_back(kept);
    if (map_->has(id)) map.keyframes.back().update(*map_->makeReference(id));
    place(map.keyframes.back(), *pose++);
  }
  return map;
}

}  // namespace mba_vo
