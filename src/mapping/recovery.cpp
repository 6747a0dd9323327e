#include "mba_vo/mapping/recovery.h"

#include <utility>

namespace mba_vo {
namespace {

constexpr double kLongestWayThere = 0.5;  // [s] for the tracker to get what was found for it
constexpr double kLeastLost = 0.05;       // [s] until a lost frame is searched for among the keyframes

}  // namespace

void Recovery::update(const LocalMap& map) {
  for (KeyframeId id = map.oldestKeyframe(); id <= map.newestKeyframe(); ++id) {
    if (map.has(id)) update(*map.makeReference(id));
  }
}

void Recovery::lose(const TrackedFrame& frame) { clock_.lose(frame.frame->mid_exposure_ns, frame.blind); }

void Recovery::passOver(const TrackedFrame& frame) {
  if (clock_.lost()) clock_.lose(frame.frame->mid_exposure_ns, true);
}

bool Recovery::isDue(const TrackedFrame& frame) const {
  const std::int64_t now = frame.frame->mid_exposure_ns;
  const bool on_its_way = found_ns_ && 1e-9 * static_cast<double>(now - *found_ns_) < kLongestWayThere;
  return !frame.blind && !on_its_way && clock_.seconds() >= kLeastLost && !isLostForGood();
}

std::optional<Relocalizer::Found> Recovery::search(const TrackedFrame& frame, double usual_error) {
  auto found = relocalizer_.find(frame.frame, usual_error);
  if (!found) return std::nullopt;
  clock_.find();
  found_ns_ = frame.frame->mid_exposure_ns;
  return found;
}

void Recovery::find() {
  clock_.find();
  found_ns_.reset();
}

void Recovery::reset() {
  find();
  relocalizer_.restart();
  relocalizer_.archive().clear();
}

std::unique_ptr<LocalMap> Recovery::windowAt(const Relocalizer::Found& found, LocalMap::Identity map,
                                             TrajectoryStore& store, CalibrationEstimator& calibration) const {
  const Reference& known = relocalizer_.archive().keyframes().at(found.keyframe).reference;
  InitialMap initial;
  initial.reference = found.keyframe_frame;
  initial.points = known.points;
  initial.metric = map.metric;
  const SE3 T_map_keyframe = store.T_map_keyframe(map.id, found.keyframe);
  const LocalMap::Place place{T_map_keyframe, map.next_keyframe, known.brightness, true};
  auto window = std::make_unique<LocalMap>(config_, map.id, initial, known.motion, place, store, calibration);
  window->inheritPoints(std::move(map.points));
  return window;
}

}  // namespace mba_vo
