#include "mba_vo/solver/reduced_camera_solver.h"

#include <gtest/gtest.h>

#include "support/random.h"

namespace mba_vo::reduced_camera_solver_test {
namespace {

/// Positive definite, block (0, n-1) and its like empty.
Eigen::MatrixXd banded(test::Random& random, int blocks) {
  const int n = 8 * blocks;
  Eigen::MatrixXd H = Eigen::MatrixXd::Identity(n, n);
  for (int k = 0; k + 1 < blocks; ++k) {
    const Eigen::MatrixXd J = random.matrix(16, 16);
    H.block(8 * k, 8 * k, 16, 16) += J.transpose() * J;
  }
  return H;
}

TEST(CholmodSolver, SolvesAndAnalysesOncePerStructure) {
  test::Random random(3);
  CholmodSolver solver(8);
  for (int i = 0; i < 3; ++i) {
    const Eigen::MatrixXd H = banded(random, 6);
    const Eigen::VectorXd b = random.matrix(48, 1);
    Eigen::VectorXd x;
    ASSERT_TRUE(solver.solve(H, b, x));
    EXPECT_LT((H * x - b).norm(), 1e-9 * b.norm());
  }
  EXPECT_EQ(solver.analyses(), 1);
  const Eigen::MatrixXd H = banded(random, 7);
  Eigen::VectorXd x;
  ASSERT_TRUE(solver.solve(H, Eigen::VectorXd::Ones(56), x));
  EXPECT_EQ(solver.analyses(), 2);
}

TEST(CholmodSolver, RefusesIndefiniteMatrixAndRecovers) {
  CholmodSolver solver(8);
  Eigen::MatrixXd H = Eigen::MatrixXd::Identity(16, 16);
  H(9, 9) = -1.0;
  Eigen::VectorXd x;
  EXPECT_FALSE(solver.solve(H, Eigen::VectorXd::Ones(16), x));
  H(9, 9) = 2.0;
  ASSERT_TRUE(solver.solve(H, Eigen::VectorXd::Ones(16), x));
  EXPECT_NEAR(x(9), 0.5, 1e-12);
}

TEST(ReducedCameraSolver, SparseAndDenseAgree) {
  test::Random random(4);
  const Eigen::MatrixXd H = banded(random, 6);
  const Eigen::VectorXd scale = Eigen::VectorXd::LinSpaced(48, -4.0, 4.0).array().exp();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * H * scale.asDiagonal();
  const Eigen::VectorXd b = random.matrix(48, 1);
  Eigen::VectorXd dense, sparse;
  ASSERT_TRUE(ReducedCameraSolver(1000).solve(scaled, b, dense));
  ASSERT_TRUE(ReducedCameraSolver(0).solve(scaled, b, sparse));
  EXPECT_LT((dense - sparse).norm(), 1e-9 * dense.norm());
  EXPECT_LT((scaled * dense + b).norm(), 1e-9 * b.norm());
  Eigen::MatrixXd indefinite = H;
  indefinite.block(0, 0, 2, 2) << 1.0, 10.0, 10.0, 1.0;
  EXPECT_FALSE(ReducedCameraSolver(1000).solve(indefinite, b, dense));
  EXPECT_FALSE(ReducedCameraSolver(0).solve(indefinite, b, sparse));
}

}  // namespace
}  // namespace mba_vo::reduced_camera_solver_test
