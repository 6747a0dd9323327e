#include "mba_vo/mapping/loop_closing.h"

#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "mba_vo/mapping/local_map.h"

namespace mba_vo {
namespace {

constexpr std::size_t kMostWaiting = 100;  // keyframes: 10 MB, and half a minute's work

std::unique_ptr<LoopQueue> queueFor(const MapperConfig& config) {
  if (!config.loops.close) return nullptr;
  const std::size_t most = config.deterministic ? std::numeric_limits<std::size_t>::max() : kMostWaiting;
  return std::make_unique<LoopQueue>(config.loops, config.tracker, most);
}

}  // namespace

LoopClosing::LoopClosing(const MapperConfig& config) : queue_(queueFor(config)) {}

LoopCounts LoopClosing::counts() const { return queue_ ? queue_->counts() : LoopCounts(); }

void LoopClosing::follow(LocalMap& map) {
  if (!queue_) return;
  for (const ArchivedKeyframeConstPtr& keyframe : map.takeDeparted()) queue_->add(keyframe);
}

void LoopClosing::close(const LocalMap& map) {
  if (!queue_) return;
  for (const ArchivedKeyframeConstPtr& keyframe : map.archived()) queue_->add(keyframe);
}

void LoopClosing::forgetMap() {
  if (queue_) queue_->forgetKeyframes();
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
    std::vector<OdometryKeyframe> keyframes;
    for (const TrajectoryStore::KeyframePlace& place : store.keyframes(id)) {
      keyframes.push_back({place.keyframe, place.T_map_keyframe, place.base});
    }
    std::vector<LoopTrial*> loops;
    for (LoopTrial& trial : smoothed.loops) {
      if (trial.map == id && trial.verdict.accepted()) loops.push_back(&trial);
    }
    for (const auto& [keyframe, S] : correctByLoops(keyframes, loops, closer.usualDepth())) {
      smoothed.corrected[{id, keyframe}] = S;
    }
  }
  smoothed.entries = store.entries(smoothed.corrected);
  return smoothed;
}

}  // namespace mba_vo
