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

/// Nodes are numbered as the keyframes are.
class Numbering {
 public:
  explicit Numbering(const std::vector<OdometryKeyframe>& keyframes) : keyframes_(keyframes) {}
  /// nullopt: there is no such keyframe.
  std::optional<int> of(KeyframeId id) const {
    const auto place = std::lower_bound(keyframes_.begin(), keyframes_.end(), id,
                                        [](const OdometryKeyframe& k, KeyframeId wanted) { return k.id < wanted; });
    if (place == keyframes_.end() || place->id != id) return std::nullopt;
    return static_cast<int>(place - keyframes_.begin());
  }

 private:
  const std::vector<OdometryKeyframe>& keyframes_;
};

/// Each keyframe hangs on the one that it was last known relative to, and the first one after a loss on the one by
/// which the camera was found.
std::vector<GraphEdge> odometryEdges(const std::vector<OdometryKeyframe>& keyframes, double depth, double drift) {
  const Numbering numbers(keyframes);
  std::vector<GraphEdge> edges;
  const auto connect = [&](int from, int to) {
    const SE3 T = keyframes[static_cast<std::size_t>(from)].T_map_keyframe.inverse() *
                  keyframes[static_cast<std::size_t>(to)].T_map_keyframe;
    edges.push_back({from, to, Sim3(T), odometryInformation(T, depth, drift)});
  };
  std::optional<int> next;  // in time, of those that hang on none
  for (int n = static_cast<int>(keyframes.size()) - 1; n >= 0; --n) {
    const OdometryKeyframe& keyframe = keyframes[static_cast<std::size_t>(n)];
    const std::optional<int> to = keyframe.base ? numbers.of(*keyframe.base) : next;
    if (!keyframe.base) next = n;
    if (to) connect(n, *to);
    if (!keyframe.continues) continue;
    if (const std::optional<int> older = numbers.of(*keyframe.continues)) connect(*older, n);
    next.reset();
  }
  return edges;
}

/// Loops between the same two stretches of the way, itself counted: they share what depths have wrong there.
std::ptrdiff_t countAlike(const LoopTrial& loop, const std::vector<LoopTrial*>& loops) {
  const auto near = [](KeyframeId l, KeyframeId r) { return (l > r ? l - r : r - l) <= kStretch; };
  return std::count_if(loops.begin(), loops.end(), [&](const LoopTrial* other) {
    return near(loop.older, other->older) && near(loop.newer, other->newer);
  });
}

/// With the least drift at which most loops are believed: they have been verified by images, the odometry has not.
PoseGraphSummary optimizeWithDrift(const std::vector<OdometryKeyframe>& keyframes, const std::vector<GraphEdge>& loops,
                                   double depth) {
  std::vector<Sim3> nodes;
  for (const OdometryKeyframe& keyframe : keyframes) nodes.emplace_back(keyframe.T_map_keyframe);
  PoseGraphSummary best;
  std::ptrdiff_t most_believed = -1;
  for (double drift = 1.0; drift <= kMostDrift; drift *= 2.0) {
    std::vector<GraphEdge> edges = odometryEdges(keyframes, depth, drift);
    edges.insert(edges.end(), loops.begin(), loops.end());
    PoseGraphSummary summary = PoseGraph(nodes, std::move(edges)).optimize();
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

CorrectedPoses correctByLoops(const std::vector<OdometryKeyframe>& keyframes, const std::vector<LoopTrial*>& loops,
                              double depth) {
  const Numbering numbers(keyframes);
  std::vector<GraphEdge> loop_edges;
  std::vector<LoopTrial*> told;  // of keyframes whose poses have not been forgotten
  for (LoopTrial* loop : loops) {
    const std::optional<int> from = numbers.of(loop->older), to = numbers.of(loop->newer);
    if (!from || !to) continue;
    const Matrix7 information = loop->verdict.covariance.inverse() / static_cast<double>(countAlike(*loop, loops));
    loop_edges.push_back({*from, *to, loop->verdict.S_old_new, information, true});
    told.push_back(loop);
  }
  if (told.empty()) return {};
  const PoseGraphSummary summary = optimizeWithDrift(keyframes, loop_edges, depth);
  for (std::size_t i = 0; i < told.size(); ++i) {
    told[i]->weight = summary.weights[summary.weights.size() - told.size() + i];
    if (told[i]->weight < kLeastWeight)
      told[i]->verdict.rejected_because = "the other loops and odometry contradict it";
  }
  const double size = 1.0 / summary.nodes.back().scale();
  const Eigen::Vector3d origin = summary.nodes.front().translation();
  CorrectedPoses corrected;
  for (std::size_t n = 0; n < keyframes.size(); ++n) {
    const Sim3& S = summary.nodes[n];
    corrected[keyframes[n].id] = Sim3(SE3(S.rotation(), origin + size * (S.translation() - origin)), size * S.scale());
  }
  return corrected;
}

}  // namespace mba_vo
