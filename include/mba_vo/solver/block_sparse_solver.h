#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace mba_vo {

/// Sparse Cholesky factorisation (SuiteSparse CHOLMOD) of a symmetric positive definite matrix made of square blocks,
/// of which only those that hold something exist: for graphs of thousands of nodes. Their pattern is analysed once.
class BlockSparseSolver {
 public:
  using Block = std::pair<int, int>;  // row and column, in blocks

  /// `blocks`: those of the lower half, diagonal aside, in any order, repeated or not. Throws std::invalid_argument if
  /// one lies elsewhere.
  BlockSparseSolver(int block_size, int blocks_per_side, std::vector<Block> blocks);
  ~BlockSparseSolver();
  BlockSparseSolver(const BlockSparseSolver&) = delete;
  BlockSparseSolver& operator=(const BlockSparseSolver&) = delete;

  void setZero();
  /// Adds to a block of the lower half; of one on the diagonal only the lower half counts.
  void add(int row, int column, const Eigen::Ref<const Eigen::MatrixXd>& values);
  /// Multiplies the diagonal by this.
  void scaleDiagonal(double factor);
  /// False if the matrix is not positive definite.
  bool factorize();
  /// Solves H X = B for each column, after factorize().
  Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mba_vo
