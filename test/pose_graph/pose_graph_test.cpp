#include "mba_vo/pose_graph/pose_graph.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <stdexcept>

#include "pose_graph/synthetic_walk.h"

namespace mba_vo::pose_graph_test {
namespace {

using test::positionError;
using test::syntheticWalk;
using test::SyntheticWalk;

Sim3 example(double seed) {
  Vector7 v;
  v << 0.3 * seed, -0.7, 1.1 - seed, 0.4 * seed, -0.9, 0.2 + 0.1 * seed, 0.3 * (seed - 1.5);
  return Sim3::fromIncrement(v);
}

TEST(PoseGraph, JacobiansAreThoseOfCentralDifferences) {
  const Sim3 from = example(1.0), to = example(2.0), edge = example(0.3);
  const EdgeJacobians J = edgeJacobians(from, to, edge);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 7; ++i) {
    const Sim3 there = Sim3::fromIncrement(kStep * Vector7::Unit(i));
    const Sim3 back = Sim3::fromIncrement(-kStep * Vector7::Unit(i));
    const Vector7 by_from = (edgeError(from * there, to, edge) - edgeError(from * back, to, edge)) / (2.0 * kStep);
    const Vector7 by_to = (edgeError(from, to * there, edge) - edgeError(from, to * back, edge)) / (2.0 * kStep);
    EXPECT_LT((J.from.col(i) - by_from).norm(), 1e-7) << "state " << i;
    EXPECT_LT((J.to.col(i) - by_to).norm(), 1e-7) << "state " << i;
  }
}

/// A generic solver that knows nothing of graphs: all weighted errors as one vector, Jacobians by central differences,
/// dense normal equations.
class DenseSolver {
 public:
  explicit DenseSolver(const SyntheticWalk& walk) : walk_(walk) {}

  Eigen::VectorXd errors(const std::vector<Sim3>& nodes) const {
    Eigen::VectorXd r(7 * static_cast<Eigen::Index>(walk_.edges.size()));
    for (std::size_t i = 0; i < walk_.edges.size(); ++i) {
      const GraphEdge& e = walk_.edges[i];
      const Vector7 error =
          edgeError(nodes[static_cast<std::size_t>(e.from)], nodes[static_cast<std::size_t>(e.to)], e.S_from_to);
      r.segment<7>(7 * static_cast<Eigen::Index>(i)) = e.information.llt().matrixU() * error;
    }
    return r;
  }
  double cost(const std::vector<Sim3>& nodes) const { return 0.5 * errors(nodes).squaredNorm(); }

  std::vector<Sim3> solve(std::vector<Sim3> nodes) const {
    const Eigen::Index states = 7 * static_cast<Eigen::Index>(nodes.size() - 1);
    for (int iteration = 0; iteration < 15; ++iteration) {
      Eigen::MatrixXd J(errors(nodes).size(), states);
      for (Eigen::Index s = 0; s < states; ++s) {
        const Eigen::VectorXd step = 1e-6 * Eigen::VectorXd::Unit(states, s);
        J.col(s) = (errors(moved(nodes, step)) - errors(moved(nodes, -step))) / 2e-6;
      }
      nodes = moved(nodes, -(J.transpose() * J).ldlt().solve(J.transpose() * errors(nodes)));
    }
    return nodes;
  }

 private:
  static std::vector<Sim3> moved(std::vector<Sim3> nodes, const Eigen::VectorXd& step) {
    for (std::size_t n = 1; n < nodes.size(); ++n) {
      nodes[n] = nodes[n] * Sim3::fromIncrement(step.segment<7>(7 * static_cast<Eigen::Index>(n - 1)));
    }
    return nodes;
  }
  const SyntheticWalk& walk_;
};

TEST(PoseGraph, FindsTheOptimumOfAGenericSolver) {
  SyntheticWalk walk = syntheticWalk(14, 6, 4, 5);
  for (GraphEdge& edge : walk.edges) edge.may_be_wrong = false;
  const PoseGraphSummary summary = PoseGraph(walk.drifted, walk.edges).optimize();
  const DenseSolver generic(walk);
  const std::vector<Sim3> expected = generic.solve(walk.drifted);
  EXPECT_NEAR(summary.cost, generic.cost(expected), 1e-6 * summary.cost);
  EXPECT_LT(summary.cost, 0.5 * generic.cost(walk.drifted));
  for (std::size_t n = 0; n < expected.size(); ++n) {
    EXPECT_LT((expected[n].inverse() * summary.nodes[n]).increment().norm(), 1e-6) << "node " << n;
  }
}

TEST(PoseGraph, LoopsTakeTheDriftOfPoseAndScaleAway) {
  const SyntheticWalk walk = syntheticWalk(200, 40, 30, 7);
  const PoseGraphSummary summary = PoseGraph(walk.drifted, walk.edges).optimize();
  EXPECT_LT(positionError(summary.nodes, walk.truth), 0.25 * positionError(walk.drifted, walk.truth));
  EXPECT_LT(std::abs(std::log(summary.nodes.back().scale())), 0.5 * std::abs(std::log(walk.drifted.back().scale())));
  for (const double weight : summary.weights) EXPECT_GT(weight, 0.2);
}

/// One in twenty joins places that have nothing to do with each other.
TEST(PoseGraph, WrongLoopsDoNoHarm) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    const SyntheticWalk walk = syntheticWalk(120, 40, 19, seed);
    const PoseGraphSummary without = PoseGraph(walk.drifted, walk.edges).optimize();
    std::mt19937 random(1000 + seed);
    std::uniform_int_distribution<int> any(0, 119);
    std::vector<GraphEdge> edges = walk.edges;
    GraphEdge wrong = edges.back();
    wrong.from = any(random);
    do {
      wrong.to = any(random);
    } while (std::abs(wrong.to - wrong.from) % 40 < 4 || std::abs(wrong.to - wrong.from) % 40 > 36);
    edges.push_back(wrong);
    const PoseGraphSummary with = PoseGraph(walk.drifted, edges).optimize();
    EXPECT_LT(with.weights.back(), 0.01) << "seed " << seed;
    EXPECT_LT(positionError(with.nodes, walk.truth), 1.05 * positionError(without.nodes, walk.truth))
        << "seed " << seed;
  }
}

TEST(PoseGraph, RefusesEdgesToNodesThatThereAreNot) {
  GraphEdge edge;
  edge.to = 2;
  EXPECT_THROW(PoseGraph(std::vector<Sim3>(2), {edge}), std::invalid_argument);
}

}  // namespace
}  // namespace mba_vo::pose_graph_test
