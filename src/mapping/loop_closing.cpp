#include "mba_vo/mapping/loop_closing.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iomanip>
#include <limits>
#include <set>
#include <sstream>
#include <utility>

namespace mba_vo {
namespace {

// Odometry is better than loops over short ways: a step that nobody would see in the image is not worth it. At a focal
// length of 400 px these are 2 px.
constexpr double kLeastStep = 0.005;       // of the depth
constexpr double kLeastTurn = 0.005;       // [rad]
constexpr std::size_t kLookedAt = 4;       // keyframes of the window: the newest, and those that must agree
constexpr std::size_t kMostWaiting = 100;  // keyframes: 10 MB, and half a minute's work

std::size_t mostWaiting(const MapperConfig& config) {
  return config.deterministic ? std::numeric_limits<std::size_t>::max() : kMostWaiting;
}

std::vector<OdometryKeyframe> keyframesOf(MapId map, const TrajectoryStore& store) {
  std::vector<OdometryKeyframe> keyframes;
  for (const TrajectoryStore::KeyframePlace& place : store.keyframes(map)) {
    keyframes.push_back({place.keyframe, place.T_map_keyframe, place.base, place.continues});
  }
  return keyframes;
}

/// Where the keyframes of a map are, by these corrections of maps that do not hang together.
template <typename Corrections>
TrajectoryStore::CorrectedKeyframes placesBy(const Corrections& corrections, const TrajectoryStore& store) {
  TrajectoryStore::CorrectedKeyframes all;
  for (const auto& correction : corrections) {
    for (const MapId map : correction.maps) {
      for (const OdometryKeyframe& keyframe : keyframesOf(map, store)) {
        const auto by_loops = correction.keyframes.find(keyframe.id);
        all[{map, keyframe.id}] = by_loops != correction.keyframes.end()
                                      ? by_loops->second
                                      : Sim3(correction.T_corrected_map * keyframe.T_map_keyframe);
      }
    }
  }
  return all;
}

/// Maps that hang together are one map: it has the id of the last.
template <typename Corrections>
std::vector<TrajectoryEntry> entriesBy(const Corrections& corrections, const TrajectoryStore& store,
                                       const TrajectoryStore::CorrectedKeyframes& places) {
  std::map<MapId, MapId> last_of;
  for (const auto& correction : corrections) {
    for (const MapId map : correction.maps) last_of[map] = correction.last();
  }
  std::vector<TrajectoryEntry> entries = store.entries(places);
  for (TrajectoryEntry& entry : entries) {
    const auto last = last_of.find(entry.map_id);
    if (last != last_of.end()) entry.map_id = last->second;
  }
  std::stable_sort(entries.begin(), entries.end(), [](const auto& l, const auto& r) { return l.map_id < r.map_id; });
  return entries;
}

std::string describe(const SE3& step) {
  constexpr double kDegrees = 180.0 / M_PI;
  std::ostringstream text;
  text << std::setprecision(2) << "the map moves by " << step.translation().norm() << " and turns by "
       << kDegrees * step.log().tail<3>().norm() << " degrees where the camera is";
  return text.str();
}

}  // namespace

LoopClosing::LoopClosing(const MapperConfig& config)
    : close_(config.loops.close),
      deterministic_(config.deterministic),
      queue_(std::make_unique<LoopQueue>(config.loops, config.tracker, mostWaiting(config))) {}

LoopCounts LoopClosing::counts() const { return queue_->counts(); }

bool LoopClosing::mayBeJoined(MapId map) const {
  if (left_.empty()) return false;
  const MapJoins joins(queue_->found().loops);
  return std::any_of(left_.begin(), left_.end(), [&](MapId other) { return !joins.areSettled(other, map); });
}

std::string LoopClosing::follow(const LocalMap& map, const std::vector<LocalMap::Departed>& departed,
                                const TrajectoryStore& store) {
  if (close_ || mayBeJoined(map.id())) {
    for (const auto& [reference, frame] : departed) queue_->add(archiveForLoops(*reference, *frame));
  }
  if (deterministic_) queue_->settled();
  const bool may_be_joined = mayBeJoined(map.id());
  if (may_be_joined && queue_->isIdle()) {
    const std::vector<ArchivedKeyframeConstPtr> newest = map.archived(kLookedAt);
    queue_->look(newest.back(), newest);
  }
  if (deterministic_) queue_->settled();
  std::string news;
  if (std::optional<Correction> solution = takeSolution()) news = adopt(std::move(*solution), map);
  solve(map, store);
  return news;
}

void LoopClosing::know(const SavedMap& earlier, MapId map) {
  if (!close_) return;
  for (ArchivedKeyframe keyframe : earlier.keyframes) {
    keyframe.reference.id.map_id = map;
    queue_->know(keyframe);
  }
}

void LoopClosing::changeWindow(const LocalMap& left, KeyframeId keyframe, const TrajectoryStore& store) {
  if (close_ || mayBeJoined(left.id())) {
    for (const ArchivedKeyframeConstPtr& archived : left.archived()) queue_->add(archived);
  }
  const auto known = std::find_if(corrections_.begin(), corrections_.end(),
                                  [&](const Correction& correction) { return correction.last() == left.id(); });
  if (known == corrections_.end()) return;
  const TrajectoryStore::CorrectedKeyframes now = corrected(store);
  for (const auto& [id, S] : now) {
    if (id.first == left.id()) known->keyframes[id.second] = S;
  }
  T_corrected_map_ = now.at({left.id(), keyframe}).rigid() * store.T_map_keyframe(left.id(), keyframe).inverse();
  known->T_corrected_map = T_corrected_map_;
}

void LoopClosing::leaveMap(const KeyframeArchive& keyframes) {
  T_corrected_map_ = SE3();
  std::vector<ArchivedKeyframe> all;
  for (const auto& [id, keyframe] : keyframes.keyframes()) all.push_back(keyframe);
  if (all.empty()) return;
  queue_->leave(all);
  if (deterministic_) queue_->settled();
  left_.insert(all.front().reference.id.map_id);
}

void LoopClosing::giveUpMap(MapId map) {
  T_corrected_map_ = SE3();
  queue_->forget(map);
  const auto has = [map](const Correction& correction) { return correction.maps.count(map) > 0; };
  corrections_.erase(std::remove_if(corrections_.begin(), corrections_.end(), has), corrections_.end());
}

void LoopClosing::forgetMaps() {
  T_corrected_map_ = SE3();
  left_.clear();
  queue_->forgetKeyframes();
}

/// nullopt if none is ready.
std::optional<LoopClosing::Correction> LoopClosing::takeSolution() {
  if (!solving_.valid()) return std::nullopt;
  if (!deterministic_ && solving_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
  return solving_.get();
}

std::vector<OdometryMap> LoopClosing::mapsOf(const std::set<MapId>& ids, const TrajectoryStore& store,
                                             const std::map<MapId, double>& usual_depths) {
  std::vector<OdometryMap> maps;
  for (const MapId id : ids) {
    const auto depth = usual_depths.find(id);
    maps.push_back({id, depth == usual_depths.end() ? 1.0 : depth->second, keyframesOf(id, store)});
  }
  return maps;
}

LoopClosing::Correction LoopClosing::correct(const std::vector<OdometryMap>& maps, std::vector<LoopTrial>& loops) {
  Correction correction;
  for (const OdometryMap& map : maps) correction.maps.insert(map.id);
  std::vector<LoopTrial*> of_maps;
  for (LoopTrial& loop : loops) {
    if (!loop.verdict.accepted() || correction.maps.count(loop.newer_map) == 0) continue;
    of_maps.push_back(&loop);
    if (loop.older_map != loop.newer_map) ++correction.joins;
  }
  correction.depth = maps.back().usual_depth;
  correction.keyframes = correctByLoops(maps, of_maps);
  if (!correction.keyframes.empty()) {
    const OdometryKeyframe& last = maps.back().keyframes.back();
    correction.T_corrected_map = correction.keyframes.at(last.id).rigid() * last.T_map_keyframe.inverse();
  }
  return correction;
}

/// If there are loops that no graph was made with, on a thread of its own.
void LoopClosing::solve(const LocalMap& map, const TrajectoryStore& store) {
  const LoopQueue::Found& found = queue_->found();
  if (solving_.valid() || found.loops.size() == solved_) return;
  solved_ = found.loops.size();
  const std::set<MapId> together = MapJoins(found.loops).joinedWith(map.id());
  solving_ = std::async(std::launch::async, [maps = mapsOf(together, store, found.usual_depths),
                                             loops = found.loops]() mutable { return correct(maps, loops); });
}

/// How the last map was joined to those that it hangs together with by keyframes of its own.
std::string LoopClosing::describeJoin(const Correction& correction) const {
  std::map<MapId, double> information;  // of the logarithm of the scale
  std::map<MapId, double> scale;        // by which lengths of that map are those of the last
  for (const LoopTrial& loop : queue_->found().loops) {
    if (loop.newer_map != correction.last() || loop.older_map == loop.newer_map) continue;
    if (correction.maps.count(loop.older_map) == 0) continue;  // found since the graph was made
    information[loop.older_map] += 1.0 / loop.verdict.covariance(6, 6);
    scale[loop.older_map] = correction.keyframes.at(loop.older).scale();
  }
  std::ostringstream text;
  text << std::setprecision(3) << "map " << correction.last() << " was joined to ";
  const char* separator = "";
  for (const auto& [map, factor] : scale) {
    text << std::exchange(separator, " and ") << "map " << map << ", whose lengths are taken times " << factor
         << " (to " << std::setprecision(1) << 100.0 / std::sqrt(information.at(map)) << " %)" << std::setprecision(3);
  }
  return text.str() + ": ";
}

std::string LoopClosing::adopt(Correction correction, const LocalMap& map) {
  if (correction.last() != map.id() || correction.keyframes.empty()) return {};
  const auto before = std::find_if(corrections_.begin(), corrections_.end(),
                                   [&](const Correction& old) { return old.maps.count(map.id()) > 0; });
  const bool joins = correction.maps.size() > (before == corrections_.end() ? 1 : before->maps.size());
  // The first keyframe that tells how two maps stand tells it least well.
  const bool joins_better = correction.joins > (before == corrections_.end() ? 0 : before->joins);
  const SE3 T_map_camera = map.stampedPose(map.newestKeyframe()).T_map_camera;
  const SE3 step = (T_corrected_map_ * T_map_camera).inverse() * correction.T_corrected_map * T_map_camera;
  const Vector6 way = step.log();
  const bool is_small = way.head<3>().norm() < kLeastStep * correction.depth && way.tail<3>().norm() < kLeastTurn;
  if (is_small && !joins_better) return {};
  T_corrected_map_ = correction.T_corrected_map;
  const std::string news = joins ? describeJoin(correction) : "a loop was closed: ";
  const auto isReplaced = [&](const Correction& old) { return correction.maps.count(old.last()) > 0; };
  corrections_.erase(std::remove_if(corrections_.begin(), corrections_.end(), isReplaced), corrections_.end());
  corrections_.push_back(std::move(correction));
  return news + describe(step);
}

TrajectoryStore::CorrectedKeyframes LoopClosing::corrected(const TrajectoryStore& store) const {
  return placesBy(corrections_, store);
}

std::vector<TrajectoryEntry> LoopClosing::trajectory(const TrajectoryStore& store) const {
  return entriesBy(corrections_, store, corrected(store));
}

SmoothedTrajectory LoopClosing::smoothed(const TrajectoryStore& store, const LocalMap* map) const {
  LoopCloser closer = queue_->settled();  // a copy: the map goes on as if nobody had asked
  if (map != nullptr && (close_ || mayBeJoined(map->id()))) {
    for (const ArchivedKeyframeConstPtr& keyframe : map->archived()) closer.add(keyframe);
  }
  SmoothedTrajectory smoothed;
  smoothed.loops = closer.trials();
  const MapJoins joins(smoothed.loops);
  std::set<MapId> maps;
  for (const LoopTrial& trial : smoothed.loops) {
    if (trial.verdict.accepted()) maps.insert(trial.newer_map);
  }
  std::vector<Correction> corrections;
  while (!maps.empty()) {
    const std::set<MapId> together = joins.joinedWith(*maps.begin());
    corrections.push_back(correct(mapsOf(together, store, closer.usualDepths()), smoothed.loops));
    for (const MapId id : together) maps.erase(id);
  }
  smoothed.corrected = placesBy(corrections, store);
  smoothed.entries = entriesBy(corrections, store, smoothed.corrected);
  return smoothed;
}

}  // namespace mba_vo
