#pragma once

#include <memory>
#include <vector>

#include "mba_vo/geometry/sim3.h"

namespace mba_vo {

/// What is known of how one node stands to another.
struct GraphEdge {
  int from = 0;
  int to = 0;
  Sim3 S_from_to;
  Matrix7 information = Matrix7::Identity();  // inverse covariance of edgeError
  bool may_be_wrong = false;                  // a loop: it counts less and less, the more it contradicts the others
};

/// D with S_from_to D = S_world_from^-1 S_world_to, as an increment: by how much the nodes disagree with the edge.
Vector7 edgeError(const Sim3& S_world_from, const Sim3& S_world_to, const Sim3& S_from_to);

struct EdgeJacobians {
  Matrix7 from, to;  // by increments S_world_node Sim3::fromIncrement(d) of either node
};
EdgeJacobians edgeJacobians(const Sim3& S_world_from, const Sim3& S_world_to, const Sim3& S_from_to);

struct PoseGraphSummary {
  std::vector<Sim3> nodes;      // S_world_node
  std::vector<double> weights;  // of the edges: 1 = believed, towards 0 = taken for wrong
  double cost = 0.0;            // half the weighted squared errors
  int iterations = 0;           // linearised, factorised and solved so often
};

/// Where nodes are by all edges between them. The first node stays where it is. Edges that may be wrong have a
/// Geman-McClure loss, which is begun so wide that it is convex and then narrowed (graduated non-convexity: Yang,
/// Antonante, Tzoumas, Carlone, 2020), so that where a drift has led to does not decide which of them are believed.
class PoseGraph {
 public:
  /// Throws std::invalid_argument if an edge tells of a node that there is not. All must hang together by edges.
  PoseGraph(std::vector<Sim3> nodes, std::vector<GraphEdge> edges);
  ~PoseGraph();

  PoseGraphSummary optimize();

  /// One step at the present weights: linearised, factorised and solved. Returns the length of the longest part of the
  /// step, relative to the nodes' scales.
  double iterate();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mba_vo
