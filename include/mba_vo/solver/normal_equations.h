#pragma once

#include <Eigen/Core>

namespace mba_vo {

/// Quadratic model of a cost about the current state: cost + gradient^T d + d^T hessian d / 2.
template <int N>
struct NormalEquations {
  Eigen::Matrix<double, N, N> hessian = Eigen::Matrix<double, N, N>::Zero();
  Eigen::Matrix<double, N, 1> gradient = Eigen::Matrix<double, N, 1>::Zero();
  double cost = 0.0;

  /// Adds 1/2 d^T information d about `deviation` (prior), for the `K` states from `first` on.
  template <int K>
  void addPrior(int first, const Eigen::Matrix<double, K, 1>& deviation,
                const Eigen::Matrix<double, K, 1>& information) {
    hessian.diagonal().template segment<K>(first) += information;
    gradient.template segment<K>(first) += information.cwiseProduct(deviation);
    cost += 0.5 * deviation.dot(information.cwiseProduct(deviation));
  }

  /// Takes the `count` states from `first` on out of the problem: their step will be zero.
  void fix(int first, int count) {
    hessian.middleRows(first, count).setZero();
    hessian.middleCols(first, count).setZero();
    hessian.diagonal().segment(first, count).setOnes();
    gradient.segment(first, count).setZero();
  }
};

}  // namespace mba_vo
