#include "mba_vo/mapping/loop_closing.h"

#include <chrono>
#include <cmath>
#include <iomanip>
#include <limits>
#include <set>
#include <sstream>
#include <utility>

#include "mba_vo/mapping/local_map.h"

namespace mba_vo {
namespace {

// Odometry is better than loops over short ways: a step that nobody would see in the image is not worth it. At a focal
// length of 400 px these are 2 px.
constexpr double kLeastStep = 0.005;       // of the depth
constexpr double kLeastTurn = 0.005;       // [rad]
constexpr std::size_t kMostWaiting = 100;  // keyframes: 10 MB, and half a minute's work

std::unique_ptr<LoopQueue> queueFor(const MapperConfig& config) {
  if (!config.loops.close) return nullptr;
  const std::size_t most = config.deterministic ? std::numeric_limits<std::size_t>::max() : kMostWaiting;
  return std::make_unique<LoopQueue>(config.loops, config.tracker, most);
}

std::vector<OdometryKeyframe> keyframesOf(MapId map, const TrajectoryStore& store) {
  std::vector<OdometryKeyframe> keyframes;
  for (const TrajectoryStore::KeyframePlace& place : store.keyframes(map)) {
    keyframes.push_back({place.keyframe, place.T_map_keyframe, place.base, place.continues});
  }
  return keyframes;
}

/// Loops of the map that are closed.
std::vector<LoopTrial*> loopsOf(MapId map, std::vector<LoopTrial>& all) {
  std::vector<LoopTrial*> loops;
  for (LoopTrial& trial : all) {
    if (trial.map == map && trial.verdict.accepted()) loops.push_back(&trial);
  }
  return loops;
}

std::string describe(const SE3& step) {
  constexpr double kDegrees = 180.0 / M_PI;
  std::ostringstream text;
  text << std::setprecision(2) << "a loop was closed: the map moves by " << step.translation().norm()
       << " and turns by " << kDegrees * step.log().tail<3>().norm() << " degrees where the camera is";
  return text.str();
}

}  // namespace

LoopClosing::LoopClosing(const MapperConfig& config) : deterministic_(config.deterministic), queue_(queueFor(config)) {}

LoopCounts LoopClosing::counts() const { return queue_ ? queue_->counts() : LoopCounts(); }

std::string LoopClosing::follow(LocalMap& map, const TrajectoryStore& store) {
  if (!queue_) return {};
  for (const ArchivedKeyframeConstPtr& keyframe : map.takeDeparted()) queue_->add(keyframe);
  if (deterministic_) queue_->settled();
  std::string news;
  if (std::optional<Correction> solution = takeSolution()) news = adopt(std::move(*solution), map);
  solve(map, store);
  return news;
}

void LoopClosing::know(const SavedMap& earlier, MapId map) {
  if (!queue_) return;
  for (const ArchivedKeyframe& keyframe : earlier.keyframes) {
    const FrameConstPtr frame = keyframe.restoreFrame();
    const std::shared_ptr<Reference> reference = keyframe.restoreReference(frame);
    reference->id.map_id = map;
    queue_->know(archiveForLoops(*reference, *frame));
  }
}

void LoopClosing::changeWindow(const LocalMap& left, KeyframeId keyframe, const TrajectoryStore& store) {
  if (!queue_) return;
  for (const ArchivedKeyframeConstPtr& archived : left.archived()) queue_->add(archived);
  const MapId map = left.id();
  const auto known = corrections_.find(map);
  if (known == corrections_.end()) return;
  const TrajectoryStore::CorrectedKeyframes now = corrected(store);
  for (const auto& [id, S] : now) {
    if (id.first == map) known->second.keyframes[id.second] = S;
  }
  T_corrected_map_ = now.at({map, keyframe}).rigid() * store.T_map_keyframe(map, keyframe).inverse();
  known->second.T_corrected_map = T_corrected_map_;
}

void LoopClosing::forgetMap() {
  T_corrected_map_ = SE3();
  if (queue_) queue_->forgetKeyframes();
}

/// nullopt if none is ready.
std::optional<LoopClosing::Correction> LoopClosing::takeSolution() {
  if (!solving_.valid()) return std::nullopt;
  if (!deterministic_ && solving_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
  return solving_.get();
}

/// If there are loops that no graph was made with, on a thread of its own.
void LoopClosing::solve(const LocalMap& map, const TrajectoryStore& store) {
  const LoopQueue::Found& found = queue_->found();
  if (solving_.valid() || found.loops.size() == solved_) return;
  solved_ = found.loops.size();
  solving_ = std::async(std::launch::async, [id = map.id(), keyframes = keyframesOf(map.id(), store), all = found.loops,
                                             depth = found.usual_depth]() mutable {
    Correction correction;
    correction.map = id;
    correction.depth = depth;
    correction.keyframes = correctByLoops(keyframes, loopsOf(id, all), depth);
    if (!correction.keyframes.empty()) {
      correction.T_corrected_map =
          correction.keyframes.rbegin()->second.rigid() * keyframes.back().T_map_keyframe.inverse();
    }
    return correction;
  });
}

std::string LoopClosing::adopt(Correction correction, const LocalMap& map) {
  if (correction.map != map.id() || correction.keyframes.empty()) return {};
  const SE3 T_map_camera = map.stampedPose(map.newestKeyframe()).T_map_camera;
  const SE3 step = (T_corrected_map_ * T_map_camera).inverse() * correction.T_corrected_map * T_map_camera;
  const Vector6 way = step.log();
  if (way.head<3>().norm() < kLeastStep * correction.depth && way.tail<3>().norm() < kLeastTurn) return {};
  T_corrected_map_ = correction.T_corrected_map;
  corrections_[correction.map] = std::move(correction);
  return describe(step);
}

TrajectoryStore::CorrectedKeyframes LoopClosing::corrected(const TrajectoryStore& store) const {
  TrajectoryStore::CorrectedKeyframes all;
  for (const auto& [map, correction] : corrections_) {
    for (const OdometryKeyframe& keyframe : keyframesOf(map, store)) {
      const auto by_loops = correction.keyframes.find(keyframe.id);
      all[{map, keyframe.id}] = by_loops != correction.keyframes.end()
                                    ? by_loops->second
                                    : Sim3(correction.T_corrected_map * keyframe.T_map_keyframe);
    }
  }
  return all;
}

SmoothedTrajectory LoopClosing::smoothed(const TrajectoryStore& store, const LocalMap* map) const {
  if (!queue_) return {store.entries(), {}, {}};
  LoopCloser closer = queue_->settled();  // a copy: the map goes on as if nobody had asked
  if (map != nullptr) {
    for (const ArchivedKeyframeConstPtr& keyframe : map->archived()) closer.add(keyframe);
  }
  SmoothedTrajectory smoothed;
  smoothed.loops = closer.trials();
  std::set<MapId> maps;
  for (const LoopTrial& trial : smoothed.loops) {
    if (trial.verdict.accepted()) maps.insert(trial.map);
  }
  for (const MapId id : maps) {
    for (const auto& [keyframe, S] :
         correctByLoops(keyframesOf(id, store), loopsOf(id, smoothed.loops), closer.usualDepth())) {
      smoothed.corrected[{id, keyframe}] = S;
    }
  }
  smoothed.entries = store.entries(smoothed.corrected);
  return smoothed;
}

}  // namespace mba_vo
