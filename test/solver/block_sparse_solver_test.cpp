#include "mba_vo/solver/block_sparse_solver.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace mba_vo::block_sparse_solver_test {
namespace {

constexpr int kBlock = 3;
constexpr int kBlocks = 6;

/// A ring with a chord, made of positive semidefinite terms between two blocks each, and as a dense matrix.
struct Example {
  BlockSparseSolver sparse;
  Eigen::MatrixXd dense;

  static std::vector<BlockSparseSolver::Block> pairs() {
    return {{1, 0}, {2, 1}, {3, 2}, {4, 3}, {5, 4}, {5, 0}, {4, 1}};
  }

  Example() : sparse(kBlock, kBlocks, pairs()), dense(Eigen::MatrixXd::Zero(kBlock * kBlocks, kBlock * kBlocks)) {
    fill();
  }

  void fill() {
    sparse.setZero();
    dense.setZero();
    for (const auto& [row, column] : pairs()) {
      const Eigen::MatrixXd J = Eigen::MatrixXd::Random(2 * kBlock, 2 * kBlock);
      const Eigen::MatrixXd H = J.transpose() * J;
      const Eigen::Index r = row * kBlock, c = column * kBlock;
      sparse.add(row, row, H.topLeftCorner(kBlock, kBlock));
      sparse.add(column, column, H.bottomRightCorner(kBlock, kBlock));
      sparse.add(row, column, H.topRightCorner(kBlock, kBlock));
      dense.block(r, r, kBlock, kBlock) += H.topLeftCorner(kBlock, kBlock);
      dense.block(c, c, kBlock, kBlock) += H.bottomRightCorner(kBlock, kBlock);
      dense.block(r, c, kBlock, kBlock) += H.topRightCorner(kBlock, kBlock);
      dense.block(c, r, kBlock, kBlock) += H.bottomLeftCorner(kBlock, kBlock);
    }
  }
};

TEST(BlockSparseSolver, SolvesWhatADenseSolverSolves) {
  std::srand(3);
  Example example;
  for (int round = 0; round < 3; ++round) {  // values change, the pattern stays
    const Eigen::MatrixXd B = Eigen::MatrixXd::Random(kBlock * kBlocks, 2);
    ASSERT_TRUE(example.sparse.factorize());
    EXPECT_TRUE(example.sparse.solve(B).isApprox(example.dense.fullPivLu().solve(B), 1e-9));
    example.sparse.scaleDiagonal(1.5);
    example.dense.diagonal() *= 1.5;
    ASSERT_TRUE(example.sparse.factorize());
    EXPECT_TRUE(example.sparse.solve(B).isApprox(example.dense.fullPivLu().solve(B), 1e-9));
    example.fill();
  }
}

TEST(BlockSparseSolver, RefusesWhatIsNotPositiveDefinite) {
  std::srand(3);
  Example example;
  example.sparse.add(2, 2, -100.0 * Eigen::MatrixXd::Identity(kBlock, kBlock));
  EXPECT_FALSE(example.sparse.factorize());
}

TEST(BlockSparseSolver, RefusesBlocksThatThePatternHasNot) {
  EXPECT_THROW(BlockSparseSolver(kBlock, kBlocks, {{0, 1}}), std::invalid_argument);
  EXPECT_THROW(BlockSparseSolver(kBlock, kBlocks, {{kBlocks, 1}}), std::invalid_argument);
  BlockSparseSolver solver(kBlock, kBlocks, {{1, 0}});
  EXPECT_THROW(solver.add(2, 0, Eigen::MatrixXd::Identity(kBlock, kBlock)), std::invalid_argument);
}

}  // namespace
}  // namespace mba_vo::block_sparse_solver_test
