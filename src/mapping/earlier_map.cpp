#include "mapper_impl.h"

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
  reset();
  earlier_ = EarlierMap{map, std::nullopt};
  lookInEarlierMap();
}

/// There is no window: the camera is looked for in what is known of the map.
void Mapper::Impl::lookInEarlierMap() {
  for (const ArchivedKeyframe& keyframe : earlier_->map.keyframes) recovery_.archive().add(keyframe);
}

MapperOutput Mapper::Impl::locate(const TrackedFrame& frame) {
  MapperOutput output;
  if (isKnownWithoutMap(*frame.frame)) return output;
  const PinholeCamera& of_map = earlier_->map.keyframes.front().camera;
  const PinholeCamera& camera = frame.frame->pyramid.level(0).camera;
  if (camera.width != of_map.width || camera.height != of_map.height) {
    return beginWithoutEarlierMap("the map that was loaded is of images of " + sizeOf(of_map) + " pixels, these have " +
                                  sizeOf(camera));
  }
  if (!calibration_) beginCalibration(frame.frame->correction);
  recovery_.lose(frame);
  output.searched = true;
  if (const auto found = recovery_.search(frame, earlier_->map.usual_error)) return goOnFrom(*found, std::move(output));
  output.message = "the camera is looked for in the map that was loaded, " +
                   std::to_string(earlier_->map.keyframes.size()) + " keyframes";
  if (config_.localize_only || recovery_.lostSeconds() < kLongestSearch) return output;
  return beginWithoutEarlierMap("the camera was not found in the map that was loaded");
}

MapperOutput Mapper::Impl::beginWithoutEarlierMap(const std::string& reason) {
  earlier_.reset();
  recovery_.reset();
  MapperOutput output;
  output.message = reason + ": a new map begins";
  return output;
}

LocalMap::Identity Mapper::Impl::identityOfEarlierMap() {
  if (!earlier_->id) earlier_->id = next_map_id_++;
  const SavedMap& map = earlier_->map;
  loops_.know(map, *earlier_->id);
  for (const ArchivedKeyframe& keyframe : map.keyframes) {
    store_.setKeyframePose(*earlier_->id, keyframe.reference.id.keyframe_id, keyframe.reference.T_map_reference);
  }
  return {*earlier_->id, map.metric, map.nextKeyframe(),
          displayPoints(map, *earlier_->id, static_cast<std::size_t>(config_.max_display_points))};
}

std::optional<SavedMap> Mapper::Impl::savedMap() const {
  if (!map_ || keepsEarlierMap()) return earlier_ ? std::optional(earlier_->map) : std::nullopt;
  SavedMap map;
  map.metric = map_->isMetric();
  map.usual_error = health_.usualFrameError();
  const TrajectoryStore::CorrectedKeyframes corrected = loops_.smoothed(store_, map_.get()).corrected;
  for (const auto& [id, kept] : recovery_.archive().keyframes()) {
    const auto by_loops = corrected.find({map_->id(), id});
    map.keyframes.push_back(kept);
    place(map.keyframes.back(),
          by_loops == corrected.end() ? Sim3(store_.T_map_keyframe(map_->id(), id)) : by_loops->second);
  }
  return map;
}

}  // namespace mba_vo
