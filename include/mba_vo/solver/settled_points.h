#pragma once

#include <vector>

#include "mba_vo/solver/schur_complement.h"

namespace mba_vo {

/// Points whose residuals hardly move any more. For the rest of an optimisation they go on as the quadratic model that
/// they were when they settled, their inverse depths eliminated: one matrix of the size of the keyframe states, however
/// many points there are.
class SettledPoints {
 public:
  void clear() { any_ = false; }
  bool any() const { return any_; }

  /// `system`: of all points, which is taken over; `settles`: by row; `others`: of those that do not settle. All at the
  /// same state.
  void settle(LinearizedWindow& system, const std::vector<bool>& settles, const LinearizedWindow& others);

  /// The keyframe states move by `step`.
  void move(const Eigen::VectorXd& step);

  /// Change of the cost since the points settled, with the depths that suit the keyframe states best.
  double costChange() const;
  /// Adds Hessian and half the gradient of the keyframe states.
  void addTo(Eigen::MatrixXd& H, Eigen::VectorXd& b) const;
  /// From the depths with which the points settled to those that suit the keyframe states best; 0 for other rows.
  Eigen::VectorXd depthSteps() const { return schur_.solveDepths(system_, moved_); }

 private:
  bool any_ = false;
  LinearizedWindow system_;  // where they settled
  SchurComplement schur_;
  ReducedSystem reduced_;
  double depth_gain_ = 0.0;  // of the cost, by the depths alone
  Eigen::VectorXd moved_;    // by how much the states have moved since the points settled
};

}  // namespace mba_vo
