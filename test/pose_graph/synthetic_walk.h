#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "mba_vo/pose_graph/pose_graph.h"

namespace mba_vo::test {

/// A camera that goes round a room again and again, seen by an odometry whose pose and scale drift, with edges that
/// close loops. Units are metres; the spread of odometry is that of a poor one: a percent of the way, and of the scale.
struct SyntheticWalk {
  std::vector<Sim3> truth;       // S_world_node, of scale 1
  std::vector<Sim3> drifted;     // by odometry alone, from the true first one on
  std::vector<GraphEdge> edges;  // odometry, then loops
};

inline Vector7 spread(double translation, double rotation, double scale) {
  Vector7 sigma;
  sigma << Eigen::Vector3d::Constant(translation), Eigen::Vector3d::Constant(rotation), scale;
  return sigma;
}

inline GraphEdge noisyEdge(const std::vector<Sim3>& truth, int from, int to, const Vector7& sigma,
                           std::mt19937& random) {
  std::normal_distribution<double> normal;
  Vector7 error;
  for (int i = 0; i < 7; ++i) error(i) = sigma(i) * normal(random);
  const Sim3 true_edge = truth[static_cast<std::size_t>(from)].inverse() * truth[static_cast<std::size_t>(to)];
  GraphEdge edge;
  edge.from = from;
  edge.to = to;
  edge.S_from_to = true_edge * Sim3::fromIncrement(error);
  edge.information = sigma.cwiseProduct(sigma).cwiseInverse().asDiagonal();
  return edge;
}

inline SyntheticWalk syntheticWalk(int nodes, int nodes_per_round, int loops, unsigned seed) {
  std::mt19937 random(seed);
  SyntheticWalk walk;
  for (int n = 0; n < nodes; ++n) {
    const double angle = 2.0 * M_PI * n / nodes_per_round;
    Vector7 v;
    v << 3.0 * std::cos(angle), 2.0 * std::sin(angle), 0.2 * std::sin(3.1 * angle), 0.1 * std::sin(1.7 * angle),
        0.2 * std::cos(0.9 * angle), std::remainder(angle, 2.0 * M_PI), 0.0;
    walk.truth.push_back(Sim3::fromIncrement(v));
  }
  const Vector7 odometry = spread(0.005, 0.003, 0.003);
  walk.drifted.push_back(walk.truth.front());
  for (int n = 1; n < nodes; ++n) {
    walk.edges.push_back(noisyEdge(walk.truth, n - 1, n, odometry, random));
    walk.drifted.push_back(walk.drifted.back() * walk.edges.back().S_from_to);
  }
  std::uniform_int_distribution<int> late(nodes_per_round, nodes - 1);
  for (int l = 0; l < loops; ++l) {
    const int to = late(random);
    const int rounds = std::uniform_int_distribution<int>(1, to / nodes_per_round)(random);
    GraphEdge edge = noisyEdge(walk.truth, to - rounds * nodes_per_round, to, spread(0.003, 0.001, 0.003), random);
    edge.may_be_wrong = true;
    walk.edges.push_back(edge);
  }
  return walk;
}

/// Root mean square of the positions' errors. Every node is as far off as it is from the first one, which is right [m].
inline double positionError(const std::vector<Sim3>& nodes, const std::vector<Sim3>& truth) {
  double sum = 0.0;
  for (std::size_t n = 0; n < nodes.size(); ++n) sum += (nodes[n].translation() - truth[n].translation()).squaredNorm();
  return std::sqrt(sum / static_cast<double>(nodes.size()));
}

}  // namespace mba_vo::test
