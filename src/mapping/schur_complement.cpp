#include "mba_vo/mapping/schur_complement.h"

namespace mba_vo {

void LinearizedWindow::setZero(int states, int points) {
  H.setZero(states, states);
  b.setZero(states);
  V.setZero(points, states);
  H_depth.setZero(points);
  b_depth.setZero(points);
}

void SchurComplement::reduce(const LinearizedWindow& system, double lambda, ReducedSystem& reduced) {
  inverse_H_depth_ = (system.H_depth.array() > 0.0).select(((1.0 + lambda) * system.H_depth.array()).inverse(), 0.0);
  reduced.H = system.H;
  reduced.H.diagonal() *= 1.0 + lambda;
  scaled_ = inverse_H_depth_.cwiseSqrt().asDiagonal() * system.V;
  reduced.H.selfadjointView<Eigen::Lower>().rankUpdate(scaled_.transpose(), -1.0);
  reduced.H.triangularView<Eigen::StrictlyUpper>() = reduced.H.transpose();
  reduced.b = system.b - system.V.transpose() * inverse_H_depth_.cwiseProduct(system.b_depth);
}

Eigen::VectorXd SchurComplement::solveDepths(const LinearizedWindow& system, const Eigen::VectorXd& step) const {
  return -inverse_H_depth_.cwiseProduct(system.b_depth + system.V * step);
}

}  // namespace mba_vo
