#include "mba_vo/pose_graph/loop_correction.h"

#include <algorithm>
#include <utility>

#include "mba_vo/pose_graph/pose_graph.h"

namespace mba_vo {
namespace {

// Standard deviations of what one keyframe is off by relative to the next: as measured, over 1 to 16 keyframes, with an
// ideal camera (scripts/loops.py --drift, recorded motions head_room2 and head_room3).
constexpr double kWayError = 0.001;     // of the way between the two
constexpr double kDepthError = 0.0001;  // of the depth, besides
constexpr double kTurnError = 0.0001;   // [rad]
constexpr double kScaleError = 0.0005;  // of the scale

constexpr double kLeastWeight = 0.1;     // of a loop that nothing contradicts
constexpr KeyframeId kStretch = 5;       // keyframes, that share depths
constexpr double kBelievedWeight = 0.5;  // of one that counts as believed
constexpr double kBelievedShare =
    0.9;                             // of the loops: if fewer are believed, it is the odometry that is worse than usual
constexpr double kMostDrift = 32.0;  // times the usual

/// `drift`: so many times as much as usual.
Matrix7 odometryInformation(const SE3& T_from_to, double depth, double drift) {
  Vector7 sigma;
  sigma << Eigen::Vector3d::Constant(kWayError * T_from_to.translation().norm() + kDepthError * depth),
      Eigen::Vector3d::Constant(kTurnError), kScaleError;
  return (drift * drift * sigma.cwiseProduct(sigma)).cwiseInverse().asDiagonal();
}

/// A keyframe, and the map that it is of.
struct Node {
  OdometryKeyframe keyframe;
  std::size_t map;
};

/// The keyframes of all maps, numbered in this order.
class Nodes {
 public:
  explicit Nodes(const std::vector<OdometryMap>& maps) {
    for (std::size_t m = 0; m < maps.size(); ++m) {
      for (const OdometryKeyframe& keyframe : maps[m].keyframes) nodes_.push_back({keyframe, m});
    }
  }
  /// nullopt: there is no such keyframe.
  std::optional<int> numberOf(KeyframeId id) const {
    const auto place = std::lower_bound(nodes_.begin(), nodes_.end(), id,
                                        [](const Node& node, KeyframeId wanted) { return node.keyframe.id < wanted; });
    if (place == nodes_.end() || place->keyframe.id != id) return std::nullopt;
    return static_cast<int>(place - nodes_.begin());
  }
  const Node& at(int number) const { return nodes_[static_cast<std::size_t>(number)]; }
  int count() const { return static_cast<int>(nodes_.size()); }
  SE3 between(int from, int to) const {
    return at(from).keyframe.T_map_keyframe.inverse() * at(to).keyframe.T_map_keyframe;
  }

 private:
  std::vector<Node> nodes_;
};

/// Each keyframe hangs on the one that it was last known relative to, and the first one after a loss on the one by
/// which the camera was found.
std::vector<GraphEdge> odometryEdges(const Nodes& nodes, const std::vector<OdometryMap>& maps, double drift) {
  std::vector<GraphEdge> edges;
  const auto connect = [&](int from, int to) {
    const SE3 T = nodes.between(from, to);
    edges.push_back({from, to, Sim3(T), odometryInformation(T, maps[nodes.at(from).map].usual_depth, drift)});
  };
  std::optional<int> next;  // in time, of those that hang on none
  for (int n = nodes.count() - 1; n >= 0; --n) {
    const OdometryKeyframe& keyframe = nodes.at(n).keyframe;
    if (next && nodes.at(*next).map != nodes.at(n).map) next.reset();
    const std::optional<int> to = keyframe.base ? nodes.numberOf(*keyframe.base) : next;
    if (!keyframe.base) next = n;
    if (to) connect(n, *to);
    if (!keyframe.continues) continue;
    if (const std::optional<int> older = nodes.numberOf(*keyframe.continues)) connect(*older, n);
    next.reset();
  }
  return edges;
}

/// Where nodes are before the graph is solved: as by odometry in their map, and the maps as the first loop between two
/// puts them.
std::vector<Sim3> firstGuess(const Nodes& nodes, const std::vector<GraphEdge>& loops) {
  std::map<std::size_t, Sim3> S_world_map{{0, Sim3()}};
  const auto poseOf = [&](int n) {
    return S_world_map.at(nodes.at(n).map) * Sim3(nodes.at(n).keyframe.T_map_keyframe);
  };
  for (bool has_grown = true; has_grown;) {
    has_grown = false;
    for (const GraphEdge& loop : loops) {
      const std::size_t from = nodes.at(loop.from).map, to = nodes.at(loop.to).map;
      if (S_world_map.count(from) == S_world_map.count(to)) continue;
      has_grown = true;
      if (S_world_map.count(from) > 0) {
        const Sim3 S_world_to = poseOf(loop.from) * loop.S_from_to;
        S_world_map[to] = S_world_to * Sim3(nodes.at(loop.to).keyframe.T_map_keyframe).inverse();
      } else {
        const Sim3 S_world_from = poseOf(loop.to) * loop.S_from_to.inverse();
        S_world_map[from] = S_world_from * Sim3(nodes.at(loop.from).keyframe.T_map_keyframe).inverse();
      }
    }
  }
  std::vector<Sim3> guess;
  for (int n = 0; n < nodes.count(); ++n) guess.push_back(poseOf(n));
  return guess;
}

/// Loops between the same two stretches of the way, itself counted: they share what depths have wrong there.
std::ptrdiff_t countAlike(const LoopTrial& loop, const std::vector<LoopTrial*>& loops) {
  const auto near = [](KeyframeId l, KeyframeId r) { return (l > r ? l - r : r - l) <= kStretch; };
  return std::count_if(loops.begin(), loops.end(), [&](const LoopTrial* other) {
    return near(loop.older, other->older) && near(loop.newer, other->newer);
  });
}

/// With the least drift at which most loops are believed: they have been verified by images, the odometry has not.
PoseGraphSummary optimizeWithDrift(const Nodes& nodes, const std::vector<OdometryMap>& maps,
                                   const std::vector<GraphEdge>& loops) {
  const std::vector<Sim3> guess = firstGuess(nodes, loops);
  PoseGraphSummary best;
  std::ptrdiff_t most_believed = -1;
  for (double drift = 1.0; drift <= kMostDrift; drift *= 2.0) {
    std::vector<GraphEdge> edges = odometryEdges(nodes, maps, drift);
    edges.insert(edges.end(), loops.begin(), loops.end());
    PoseGraphSummary summary = PoseGraph(guess, std::move(edges)).optimize();
    const auto believed = std::count_if(summary.weights.end() - static_cast<std::ptrdiff_t>(loops.size()),
                                        summary.weights.end(), [](double weight) { return weight > kBelievedWeight; });
    if (believed > most_believed) {
      most_believed = believed;
      best = std::move(summary);
    }
    if (static_cast<double>(believed) >= kBelievedShare * static_cast<double>(loops.size())) break;
  }
  return best;
}

}  // namespace

CorrectedPoses correctByLoops(const std::vector<OdometryMap>& maps, const std::vector<LoopTrial*>& loops) {
  const Nodes nodes(maps);
  std::vector<GraphEdge> loop_edges;
  std::vector<LoopTrial*> told;  // of keyframes whose poses have not been forgotten
  for (LoopTrial* loop : loops) {
    const std::optional<int> from = nodes.numberOf(loop->older), to = nodes.numberOf(loop->newer);
    if (!from || !to) continue;
    const Matrix7 information = loop->verdict.covariance.inverse() / static_cast<double>(countAlike(*loop, loops));
    loop_edges.push_back({*from, *to, loop->verdict.S_old_new, information, true});
    told.push_back(loop);
  }
  if (told.empty()) return {};
  const PoseGraphSummary summary = optimizeWithDrift(nodes, maps, loop_edges);
  for (std::size_t i = 0; i < told.size(); ++i) {
    told[i]->weight = summary.weights[summary.weights.size() - told.size() + i];
    if (told[i]->weight < kLeastWeight)
      told[i]->verdict.rejected_because = "the other loops and odometry contradict it";
  }
  const double size = 1.0 / summary.nodes.back().scale();
  const Eigen::Vector3d origin = summary.nodes.front().translation();
  CorrectedPoses corrected;
  for (int n = 0; n < nodes.count(); ++n) {
    const Sim3& S = summary.nodes[static_cast<std::size_t>(n)];
    corrected[nodes.at(n).keyframe.id] =
        Sim3(SE3(S.rotation(), origin + size * (S.translation() - origin)), size * S.scale());
  }
  return corrected;
}

}  // namespace mba_vo
