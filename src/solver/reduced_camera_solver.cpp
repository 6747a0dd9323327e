#include "mba_vo/solver/reduced_camera_solver.h"

#include <Eigen/Cholesky>

namespace mba_vo {

ReducedCameraSolver::ReducedCameraSolver(int max_dense)
    : max_dense_(max_dense), sparse_(std::make_unique<CholmodSolver>(8)) {}

ReducedCameraSolver::~ReducedCameraSolver() = default;

bool ReducedCameraSolver::solve(const Eigen::MatrixXd& H, const Eigen::VectorXd& b, Eigen::VectorXd& x) {
  if (!(H.diagonal().array() > 0.0).all() || !b.allFinite()) return false;
  const Eigen::VectorXd scale = H.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * H * scale.asDiagonal();
  const Eigen::VectorXd rhs = -(scale.asDiagonal() * b);
  if (H.rows() <= max_dense_) {
    const Eigen::LDLT<Eigen::MatrixXd> ldlt(scaled);
    if (ldlt.info() != Eigen::Success || !ldlt.isPositive()) return false;
    x = ldlt.solve(rhs);
  } else if (!sparse_->solve(scaled, rhs, x)) {
    return false;
  }
  x = (scale.asDiagonal() * x).eval();
  return x.allFinite();
}

}  // namespace mba_vo
