#pragma once

#include <Eigen/Core>

namespace mba_vo::test {

/// Central differences of `f` (VectorXd-like result) over a tangent vector of dimension `n` about zero.
template <typename F>
Eigen::MatrixXd numericJacobian(const F& f, int n, double step = 1e-6) {
  Eigen::VectorXd d = Eigen::VectorXd::Zero(n);
  const Eigen::VectorXd f0 = f(d);
  Eigen::MatrixXd jacobian(f0.size(), n);
  for (int i = 0; i < n; ++i) {
    d.setZero();
    d(i) = step;
    const Eigen::VectorXd plus = f(d);
    d(i) = -step;
    const Eigen::VectorXd minus = f(d);
    jacobian.col(i) = (plus - minus) / (2.0 * step);
  }
  return jacobian;
}

}  // namespace mba_vo::test
