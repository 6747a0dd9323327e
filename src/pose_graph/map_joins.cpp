#include "mba_vo/pose_graph/map_joins.h"

namespace mba_vo {
namespace {

constexpr int kEnoughJoins = 3;  // between two maps: their scale is then known to less than one of them says

}  // namespace

MapJoins::MapJoins(const std::vector<LoopTrial>& trials) {
  for (const LoopTrial& trial : trials) {
    if (!trial.verdict.accepted() || trial.older_map == trial.newer_map) continue;
    ++joins_[trial.older_map][trial.newer_map];
    ++joins_[trial.newer_map][trial.older_map];
  }
}

std::set<MapId> MapJoins::joinedWith(MapId map) const {
  std::set<MapId> found{map};
  std::vector<MapId> unvisited{map};
  while (!unvisited.empty()) {
    const auto from = joins_.find(unvisited.back());
    unvisited.pop_back();
    if (from == joins_.end()) continue;
    for (const auto& [to, count] : from->second) {
      if (found.insert(to).second) unvisited.push_back(to);
    }
  }
  return found;
}

bool MapJoins::areSettled(MapId a, MapId b) const {
  if (const auto from = joins_.find(a); from != joins_.end()) {
    if (const auto to = from->second.find(b); to != from->second.end()) return to->second >= kEnoughJoins;
  }
  return joinedWith(a).count(b) > 0;
}

}  // namespace mba_vo
