#pragma once

#include <Eigen/Core>

namespace mba_vo {

/// Normal equations of keyframe states x and inverse depths d, where each depth is alone in its block:
///   [ H    V^T ] [x]     [b  ]
///   [ V    D   ] [d] = - [b_d]
struct LinearizedWindow {
  using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::MatrixXd H;  // symmetric, both halves filled
  Eigen::VectorXd b;
  RowMatrix V;              // one row per point
  Eigen::VectorXd H_depth;  // D
  Eigen::VectorXd b_depth;

  void setZero(int states, int points);
};

/// The system of the keyframes after eliminating the depths.
struct ReducedSystem {
  Eigen::MatrixXd H;  // symmetric, both halves filled
  Eigen::VectorXd b;
};

/// Eliminates the inverse depths. All diagonal entries are first multiplied by 1 + lambda (`system` stays as it is, so
/// damping never accumulates). Points without information are left out.
class SchurComplement {
 public:
  void reduce(const LinearizedWindow& system, double lambda, ReducedSystem& reduced);
  /// Steps of the inverse depths for a step of the keyframe states, with the damping of the last `reduce`.
  Eigen::VectorXd solveDepths(const LinearizedWindow& system, const Eigen::VectorXd& step) const;

 private:
  Eigen::VectorXd inverse_H_depth_;  // 0 for points without information
};

}  // namespace mba_vo
