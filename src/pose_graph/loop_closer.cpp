#include "mba_vo/pose_graph/loop_closer.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "mba_vo/geometry/median.h"
#include "mba_vo/pose_graph/map_joins.h"
#include "mba_vo/tracking/frame_measures.h"

namespace mba_vo {
namespace {

constexpr double kLeastCorrelation = 0.5;  // of small images, worth a comparison
constexpr double kLeastAway = 4.0;         // [s] since the older keyframe: before, it is the window's affair
constexpr double kNearby = 0.3;      // [median depths] to the nearest keyframe, by odometry, if they look the same way
constexpr double kNearbyTurn = 0.7;  // [rad] between the two, if they are at the same place
constexpr std::size_t kLeastKept = 3;        // keyframes, whatever the memory
constexpr std::size_t kMostRejected = 2000;  // trials that are remembered: 2 MB
constexpr KeyframeId kBeside = 12;           // keyframes on either side that may be witnesses
constexpr std::size_t kWitnessesASide = 3;
constexpr double kDrift = 0.1;         // of the way between the two, that odometry may be off by
constexpr double kDriftAtOnce = 0.3;   // [median depths], besides
constexpr double kTurnDrift = 0.01;    // [rad] for each keyframe between
constexpr double kTurnAtOnce = 0.2;    // [rad], besides
constexpr double kScaleDrift = 0.005;  // for each keyframe between
constexpr double kScaleAtOnce = 0.05;  // besides

}  // namespace

LoopCloser::LoopCloser(const LoopConfig& config, const TrackerConfig& tracker) : config_(config), verifier_(tracker) {}

void LoopCloser::forgetKeyframes() {
  kept_.clear();
  bytes_ = 0;
  index_ = {};
}

void LoopCloser::forget(MapId map) {
  for (auto next = kept_.begin(); next != kept_.end();) {
    const auto kept = next++;
    if (kept->second.map() == map) drop(kept->first);
  }
  for (LoopTrial& trial : trials_) {
    const bool of_it = trial.older_map == map || trial.newer_map == map;
    if (of_it && trial.verdict.accepted()) trial.verdict.rejected_because = "its map was given up";
  }
}

std::map<MapId, double> LoopCloser::usualDepths() const {
  std::map<MapId, double> usual;
  for (const auto& [id, kept] : kept_) usual.emplace(kept.map(), 1.0);
  for (auto& [map, depth] : usual) depth = usualDepth(map);
  return usual;
}

double LoopCloser::usualDepth(MapId map) const {
  std::vector<double> depths;
  for (const auto& [id, kept] : kept_) {
    if (kept.map() == map) depths.push_back(kept.median_depth);
  }
  return depths.empty() ? 1.0 : median(depths);
}

void LoopCloser::add(const ArchivedKeyframeConstPtr& keyframe) {
  const PlaceDescriptor descriptor(keyframe->restoreFrame()->pyramid);
  const Neighbours beside = keptBeside(*keyframe);
  if (config_.close) {
    for (LoopTrial& trial : compare(keyframe, descriptor, beside, Among::kItsMap)) remember(std::move(trial));
  }
  for (LoopTrial& trial : compare(keyframe, descriptor, beside, Among::kOtherMaps)) remember(std::move(trial));
  keep(keyframe, descriptor);
}

void LoopCloser::look(const ArchivedKeyframeConstPtr& keyframe, const std::vector<ArchivedKeyframeConstPtr>& beside) {
  Neighbours neighbours;
  for (const ArchivedKeyframeConstPtr& other : beside) neighbours[other->reference.id.keyframe_id] = other;
  std::vector<LoopTrial> trials =
      compare(keyframe, PlaceDescriptor(keyframe->restoreFrame()->pyramid), neighbours, Among::kOtherMaps);
  if (!trials.empty() && trials.back().verdict.accepted()) remember(std::move(trials.back()));
}

std::vector<LoopTrial> LoopCloser::compare(const ArchivedKeyframeConstPtr& keyframe, const PlaceDescriptor& descriptor,
                                           const Neighbours& beside, Among among) const {
  std::vector<LoopTrial> trials;
  for (const Candidate& candidate : candidatesFor(*keyframe, descriptor, among)) {
    const ArchivedKeyframeConstPtr& older = kept_.at(candidate.keyframe).keyframe;
    LoopTrial trial;
    trial.older_map = older->reference.id.map_id;
    trial.newer_map = keyframe->reference.id.map_id;
    trial.older = candidate.keyframe;
    trial.newer = keyframe->reference.id.keyframe_id;
    trial.older_ns = older->reference.mid_exposure_ns;
    trial.newer_ns = keyframe->reference.mid_exposure_ns;
    trial.T_map_newer = keyframe->reference.T_map_reference;
    trial.correlation = candidate.correlation;
    trial.verdict = verifier_.verify(older, keyframe, candidate.starts, witnessesOf(*older, *keyframe, beside));
    if (trial.verdict.accepted()) trial.verdict.rejected_because = contradiction(trial);
    trials.push_back(std::move(trial));
    if (trials.back().verdict.accepted()) break;
  }
  return trials;
}

/// Of those that were rejected the oldest go: nobody looks for them after hours.
void LoopCloser::remember(LoopTrial trial) {
  ++compared_;
  if (trial.verdict.accepted()) ++closed_;
  trials_.push_back(std::move(trial));
  if (trials_.size() <= closed_ + kMostRejected) return;
  trials_.erase(
      std::find_if(trials_.begin(), trials_.end(), [](const LoopTrial& old) { return !old.verdict.accepted(); }));
}

void LoopCloser::know(const ArchivedKeyframeConstPtr& keyframe) {
  keep(keyframe, PlaceDescriptor(keyframe->restoreFrame()->pyramid));
}

void LoopCloser::keep(const ArchivedKeyframeConstPtr& keyframe, const PlaceDescriptor& descriptor) {
  const KeyframeId id = keyframe->reference.id.keyframe_id;
  if (kept_.count(id) > 0) drop(id);
  index_.add(id, descriptor);
  bytes_ += bytesOf(*keyframe) + sizeof(PlaceDescriptor);
  kept_.insert_or_assign(id, Kept{keyframe, medianDepth(keyframe->reference)});
  while (1e-6 * static_cast<double>(bytes_) > config_.max_megabytes && kept_.size() > kLeastKept) dropMostRedundant();
}

void LoopCloser::drop(KeyframeId keyframe) {
  const auto kept = kept_.find(keyframe);
  bytes_ -= bytesOf(*kept->second.keyframe) + sizeof(PlaceDescriptor);
  index_.remove(keyframe);
  kept_.erase(kept);
}

/// Of the map that has most: what says least can only be told within one.
void LoopCloser::dropMostRedundant() {
  const MapId map = largestMap();
  std::vector<const Reference*> references;
  for (const auto& [id, kept] : kept_) {
    if (kept.map() == map) references.push_back(&kept.keyframe->reference);
  }
  const std::size_t redundant = references.size() < kLeastKept ? 0 : mostRedundant(references, usualDepth(map));
  drop(references[redundant]->id.keyframe_id);
}

MapId LoopCloser::largestMap() const {
  std::map<MapId, int> counts;
  for (const auto& [id, kept] : kept_) ++counts[kept.map()];
  return std::max_element(counts.begin(), counts.end(),
                          [](const auto& l, const auto& r) { return l.second < r.second; })
      ->first;
}

bool LoopCloser::isElsewhere(const Kept& candidate, const ArchivedKeyframe& keyframe) const {
  const std::int64_t away = keyframe.reference.mid_exposure_ns - candidate.keyframe->reference.mid_exposure_ns;
  // What the window still knows is not for us: it was seen all the time.
  return 1e-9 * static_cast<double>(away) > kLeastAway &&
         keyframe.reference.T_map_keyframe.count(candidate.keyframe->reference.id.keyframe_id) == 0;
}

SE3 LoopCloser::byOdometry(const ArchivedKeyframe& older, const ArchivedKeyframe& newer) {
  return older.reference.T_map_reference.inverse() * newer.reference.T_map_reference;
}

/// Where odometry leads, and, as that drifts, those that look alike wherever they are; in other maps these only.
std::vector<LoopCloser::Candidate> LoopCloser::candidatesFor(const ArchivedKeyframe& keyframe,
                                                             const PlaceDescriptor& descriptor, Among among) const {
  std::vector<Candidate> candidates;
  const MapId map = keyframe.reference.id.map_id;
  if (among == Among::kItsMap) {
    if (const std::optional<Candidate> nearest = nearestByOdometry(keyframe)) candidates.push_back(*nearest);
  }
  const MapJoins joins(trials_);
  const std::set<MapId> known = mapsShownBy(keyframe.reference.id.keyframe_id);
  const auto wanted = [&](KeyframeId id) {
    const Kept& kept = kept_.at(id);
    if (among == Among::kItsMap) return kept.map() == map && isElsewhere(kept, keyframe);
    return kept.map() != map && known.count(kept.map()) == 0 && !joins.areSettled(kept.map(), map);
  };
  for (const PlaceCandidate& alike : index_.search(descriptor, static_cast<std::size_t>(config_.candidates), wanted)) {
    if (alike.correlation < kLeastCorrelation) break;
    if (!candidates.empty() && candidates.front().keyframe == alike.keyframe) {
      candidates.front().correlation = alike.correlation;
      continue;
    }
    candidates.push_back({alike.keyframe, alike.correlation, startsFor(alike, keyframe)});
  }
  return candidates;
}

/// Others, by what has been found of this keyframe: once more it would tell nothing new.
std::set<MapId> LoopCloser::mapsShownBy(KeyframeId keyframe) const {
  std::set<MapId> maps;
  for (const LoopTrial& trial : trials_) {
    if (trial.newer == keyframe && trial.verdict.accepted()) maps.insert(trial.older_map);
  }
  return maps;
}

std::vector<SE3> LoopCloser::startsFor(const PlaceCandidate& alike, const ArchivedKeyframe& keyframe) const {
  const ArchivedKeyframe& older = *kept_.at(alike.keyframe).keyframe;
  Vector6 turn = Vector6::Zero();
  turn(3) = -std::atan2(alike.shift_px.y(), older.camera.fy);
  turn(4) = std::atan2(alike.shift_px.x(), older.camera.fx);
  std::vector<SE3> starts{SE3::exp(turn)};
  if (older.reference.id.map_id == keyframe.reference.id.map_id) starts.push_back(byOdometry(older, keyframe));
  return starts;
}

std::optional<LoopCloser::Candidate> LoopCloser::nearestByOdometry(const ArchivedKeyframe& keyframe) const {
  const MapId map = keyframe.reference.id.map_id;
  const double depth = usualDepth(map);
  std::optional<Candidate> nearest;
  double least = 1.0;
  for (const auto& [id, kept] : kept_) {
    if (kept.map() != map || !isElsewhere(kept, keyframe)) continue;
    const SE3 T = byOdometry(*kept.keyframe, keyframe);
    const double away = T.translation().norm() / (kNearby * depth) + T.log().tail<3>().norm() / kNearbyTurn;
    if (away >= least) continue;
    least = away;
    nearest = Candidate{id, std::nullopt, {T}};
  }
  return nearest;
}

LoopCloser::Neighbours LoopCloser::keptBeside(const ArchivedKeyframe& keyframe) const {
  const KeyframeId id = keyframe.reference.id.keyframe_id;
  Neighbours near;
  for (auto other = kept_.lower_bound(id > kBeside ? id - kBeside : 0);
       other != kept_.end() && other->first <= id + kBeside; ++other) {
    if (other->second.map() == keyframe.reference.id.map_id) near.emplace(other->first, other->second.keyframe);
  }
  return near;
}

/// Those nearby in time, the nearest first: only those are told by odometry exactly enough.
std::vector<LoopWitness> LoopCloser::nearestOf(const Neighbours& others, const ArchivedKeyframe& keyframe,
                                               bool is_old) {
  const KeyframeId id = keyframe.reference.id.keyframe_id;
  std::vector<std::pair<KeyframeId, ArchivedKeyframeConstPtr>> near;
  for (const auto& [other, archived] : others) {
    if (other != id) near.emplace_back(other > id ? other - id : id - other, archived);
  }
  std::stable_sort(near.begin(), near.end(), [](const auto& l, const auto& r) { return l.first < r.first; });
  if (near.size() > kWitnessesASide) near.resize(kWitnessesASide);
  std::vector<LoopWitness> witnesses;
  for (const auto& [distance, other] : near) {
    witnesses.push_back(
        {other, keyframe.reference.T_map_reference.inverse() * other->reference.T_map_reference, is_old});
  }
  return witnesses;
}

std::vector<LoopWitness> LoopCloser::witnessesOf(const ArchivedKeyframe& older, const ArchivedKeyframe& newer,
                                                 const Neighbours& beside_newer) const {
  const std::vector<LoopWitness> of_older = nearestOf(keptBeside(older), older, true);
  const std::vector<LoopWitness> of_newer = nearestOf(beside_newer, newer, false);
  std::vector<LoopWitness> all;
  for (std::size_t i = 0; i < kWitnessesASide; ++i) {
    if (i < of_newer.size()) all.push_back(of_newer[i]);
    if (i < of_older.size()) all.push_back(of_older[i]);
  }
  return all;
}

std::string LoopCloser::contradiction(const LoopTrial& trial) const {
  if (trial.older_map != trial.newer_map) return {};  // odometry has not led from one to the other
  const Reference& older = kept_.at(trial.older).keyframe->reference;
  double way = 0.0;
  const Reference* before = &older;
  for (auto k = kept_.upper_bound(trial.older); k != kept_.end() && k->first < trial.newer; ++k) {
    const Reference& next = k->second.keyframe->reference;
    way += (next.T_map_reference.translation() - before->T_map_reference.translation()).norm();
    before = &next;
  }
  const auto between = static_cast<double>(trial.newer - trial.older);
  const Sim3& S = trial.verdict.S_old_new;
  const SE3 by_odometry = older.T_map_reference.inverse() * trial.T_map_newer;
  const Vector6 off = (by_odometry.inverse() * S.rigid()).log();
  if (off.head<3>().norm() > kDrift * way + kDriftAtOnce * usualDepth(trial.newer_map))
    return "odometry puts it elsewhere";
  if (off.tail<3>().norm() > kTurnDrift * between + kTurnAtOnce) return "odometry turns it elsewhere";
  if (std::abs(std::log(S.scale())) > kScaleDrift * between + kScaleAtOnce)
    return "the scale cannot have drifted so far";
  return {};
}

}  // namespace mba_vo
