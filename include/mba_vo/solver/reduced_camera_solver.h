#pragma once

#include <memory>

#include <Eigen/Core>

namespace mba_vo {

/// Sparse Cholesky factorisation (SuiteSparse CHOLMOD) of a symmetric positive definite matrix made of square blocks,
/// blocks that are all zero left out. The structure is analysed once and again only when it changes.
class CholmodSolver {
 public:
  explicit CholmodSolver(int block_size);
  ~CholmodSolver();
  CholmodSolver(const CholmodSolver&) = delete;
  CholmodSolver& operator=(const CholmodSolver&) = delete;

  /// Solves H x = b from the lower half of H. False if H is not positive definite.
  bool solve(const Eigen::MatrixXd& H, const Eigen::VectorXd& b, Eigen::VectorXd& x);
  /// How often the structure was analysed.
  int analyses() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Solves H x = -b of the keyframe states. H is scaled to a unit diagonal first because metres, radians and grey levels
/// differ by many orders of magnitude. Small systems, whose blocks are nearly all filled, are factorised densely.
class ReducedCameraSolver {
 public:
  /// `max_dense`: largest number of states solved densely.
  explicit ReducedCameraSolver(int max_dense = kMaxDense);
  ~ReducedCameraSolver();

  bool solve(const Eigen::MatrixXd& H, const Eigen::VectorXd& b, Eigen::VectorXd& x);

  static constexpr int kMaxDense = 96;

 private:
  int max_dense_;
  std::unique_ptr<CholmodSolver> sparse_;
};

}  // namespace mba_vo
