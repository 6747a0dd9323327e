#include "mba_vo/pose_graph/pose_graph.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "mba_vo/solver/block_sparse_solver.h"

namespace mba_vo {
namespace {

constexpr double kBelievedError = 24.3;  // squared, in standard deviations: 99.9 % of seven degrees of freedom
constexpr double kNarrowing = 1.4;       // of the loss from step to step; as in the paper on graduated non-convexity
constexpr double kWidestLoss = 1e8;      // of its square, times kBelievedError: wider is as good as quadratic
constexpr int kStepsPerWidth = 1;        // the next width begins nearby
constexpr int kLastSteps = 30;           // with the loss as it is meant
constexpr int kMostRejections = 8;       // in a row
constexpr double kFirstDamping = 1e-8;   // relative to the diagonal: little, the start is good and errors are small
constexpr double kSmallestStep = 1e-7;   // [units, rad]

/// J_r^-1 of rotations: d log(R Exp(phi)) = J_r^-1 phi.
Eigen::Matrix3d inverseRightJacobian(const Eigen::Vector3d& phi) {
  Vector6 turn = Vector6::Zero();
  turn.tail<3>() = phi;
  return rightJacobian(turn).bottomRightCorner<3, 3>().inverse();
}

}  // namespace

Vector7 edgeError(const Sim3& S_world_from, const Sim3& S_world_to, const Sim3& S_from_to) {
  return (S_from_to.inverse() * (S_world_from.inverse() * S_world_to)).increment();
}

/// To first order: with A = S_world_from^-1 S_world_to and E = Z^-1 A, an increment (rho, phi, sigma) of `to` makes E
/// of E D, one of `from` Z^-1 D^-1 A, where D^-1 moves the translation of A by phi^ x -rho - sigma t.
EdgeJacobians edgeJacobians(const Sim3& S_world_from, const Sim3& S_world_to, const Sim3& S_from_to) {
  const Sim3 A = S_world_from.inverse() * S_world_to;
  const Sim3 E = S_from_to.inverse() * A;
  const Eigen::Matrix3d inverse_jacobian = inverseRightJacobian(E.increment().segment<3>(3));
  const Eigen::Matrix3d back = S_from_to.rotationMatrix().transpose() / S_from_to.scale();
  EdgeJacobians J{Matrix7::Zero(), Matrix7::Zero()};
  J.to.topLeftCorner<3, 3>() = E.scale() * E.rotationMatrix();
  J.to.block<3, 3>(3, 3) = inverse_jacobian;
  J.to(6, 6) = 1.0;
  J.from.topLeftCorner<3, 3>() = -back;
  J.from.block<3, 3>(0, 3) = back * hat(A.translation());
  J.from.block<3, 1>(0, 6) = -back * A.translation();
  J.from.block<3, 3>(3, 3) = -inverse_jacobian * A.rotationMatrix().transpose();
  J.from(6, 6) = -1.0;
  return J;
}

class PoseGraph::Impl {
 public:
  Impl(std::vector<Sim3> nodes, std::vector<GraphEdge> edges)
      : nodes_(std::move(nodes)),
        edges_(std::move(edges)),
        weights_(edges_.size(), 1.0),
        solver_(7, states(), pattern()) {}

  PoseGraphSummary optimize() {
    PoseGraphSummary summary;
    for (double width = firstWidth(); width > 1.0; width /= kNarrowing) {
      weigh(width);
      for (int i = 0; i < kStepsPerWidth; ++i) iterate();
    }
    for (int i = 0; i < kLastSteps; ++i) {
      weigh(1.0);
      if (iterate() < kSmallestStep) break;
    }
    weigh(1.0);
    return {nodes_, weights_, cost(nodes_), iterations_};
  }

  /// Damped until the cost is lower.
  double iterate() {
    ++iterations_;
    const double before = cost(nodes_);
    for (int rejected = 0; rejected < kMostRejections; ++rejected) {
      const Eigen::VectorXd gradient = linearize();
      solver_.scaleDiagonal(1.0 + damping_);
      if (!solver_.factorize()) {
        damping_ *= 100.0;
        continue;
      }
      const Eigen::VectorXd step = -solver_.solve(gradient);
      std::vector<Sim3> moved = nodes_;
      for (int n = 1; n < static_cast<int>(nodes_.size()); ++n) {
        Sim3& node = moved[static_cast<std::size_t>(n)];
        node = node * Sim3::fromIncrement(step.segment<7>(7 * (n - 1)));
      }
      if (cost(moved) <= before * (1.0 + 1e-12)) {
        nodes_ = std::move(moved);
        damping_ = std::max(0.1 * damping_, kFirstDamping);
        return step.size() > 0 ? step.lpNorm<Eigen::Infinity>() : 0.0;
      }
      damping_ *= 100.0;
    }
    damping_ = kFirstDamping;
    return 0.0;
  }

 private:
  int states() const { return std::max(static_cast<int>(nodes_.size()) - 1, 0); }
  const Sim3& node(int n) const { return nodes_[static_cast<std::size_t>(n)]; }

  std::vector<BlockSparseSolver::Block> pattern() const {
    std::vector<BlockSparseSolver::Block> blocks;
    const int count = static_cast<int>(nodes_.size());
    for (const GraphEdge& e : edges_) {
      if (e.from == e.to || std::min(e.from, e.to) < 0 || std::max(e.from, e.to) >= count) {
        throw std::invalid_argument("no edge can lead from node " + std::to_string(e.from) + " to node " +
                                    std::to_string(e.to) + " of " + std::to_string(count));
      }
      if (e.from > 0 && e.to > 0) blocks.emplace_back(std::max(e.from, e.to) - 1, std::min(e.from, e.to) - 1);
    }
    return blocks;
  }

  double squaredError(const GraphEdge& e, const std::vector<Sim3>& nodes) const {
    const Vector7 r =
        edgeError(nodes[static_cast<std::size_t>(e.from)], nodes[static_cast<std::size_t>(e.to)], e.S_from_to);
    return r.dot(e.information * r);
  }

  double cost(const std::vector<Sim3>& nodes) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < edges_.size(); ++i) sum += 0.5 * weights_[i] * squaredError(edges_[i], nodes);
    return sum;
  }

  /// So wide that the loss is nearly quadratic for the largest error.
  double firstWidth() const {
    double largest = 0.0;
    for (const GraphEdge& e : edges_) {
      if (e.may_be_wrong) largest = std::max(largest, squaredError(e, nodes_));
    }
    return std::min(2.0 * largest / kBelievedError, kWidestLoss);
  }

  void weigh(double width) {
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      if (!edges_[i].may_be_wrong) continue;
      const double scale = width * kBelievedError;
      const double share = scale / (squaredError(edges_[i], nodes_) + scale);
      weights_[i] = share * share;
    }
  }

  Eigen::VectorXd linearize() {
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(7 * states());
    solver_.setZero();
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      const GraphEdge& e = edges_[i];
      const EdgeJacobians J = edgeJacobians(node(e.from), node(e.to), e.S_from_to);
      const Matrix7 information = weights_[i] * e.information;
      const Vector7 pull = information * edgeError(node(e.from), node(e.to), e.S_from_to);
      const Matrix7 from = J.from.transpose() * information;
      const Matrix7 to = J.to.transpose() * information;
      const auto end = [&](int n, const Matrix7& by, const Matrix7& jacobian) {
        if (n == 0) return;
        solver_.add(n - 1, n - 1, by * jacobian);
        gradient.segment<7>(7 * (n - 1)) += jacobian.transpose() * pull;
      };
      end(e.from, from, J.from);
      end(e.to, to, J.to);
      if (e.from == 0 || e.to == 0) continue;
      if (e.from > e.to) {
        solver_.add(e.from - 1, e.to - 1, from * J.to);
      } else {
        solver_.add(e.to - 1, e.from - 1, to * J.from);
      }
    }
    return gradient;
  }

  std::vector<Sim3> nodes_;
  std::vector<GraphEdge> edges_;
  std::vector<double> weights_;
  BlockSparseSolver solver_;
  double damping_ = kFirstDamping;
  int iterations_ = 0;
};

PoseGraph::PoseGraph(std::vector<Sim3> nodes, std::vector<GraphEdge> edges)
    : impl_(std::make_unique<Impl>(std::move(nodes), std::move(edges))) {}
PoseGraph::~PoseGraph() = default;
PoseGraphSummary PoseGraph::optimize() { return impl_->optimize(); }
double PoseGraph::iterate() { return impl_->iterate(); }

}  // namespace mba_vo
