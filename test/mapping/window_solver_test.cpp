#include <gtest/gtest.h>
#include <Eigen/Dense>

#include "mba_vo/mapping/marginalization_prior.h"
#include "mba_vo/mapping/reduced_camera_solver.h"
#include "mba_vo/mapping/schur_complement.h"
#include "support/random.h"

namespace mba_vo {
namespace {

Eigen::MatrixXd randomMatrix(test::Random& random, int rows, int cols) {
  return Eigen::MatrixXd::NullaryExpr(rows, cols, [&](Eigen::Index, Eigen::Index) { return random.normal(1.0); });
}

/// A random least-squares problem: `states` camera states, `points` depths, each depth in four residuals of its own.
struct Problem {
  LinearizedWindow system;
  Eigen::MatrixXd H_full;
  Eigen::VectorXd b_full;
};

Problem randomProblem(test::Random& random, int states, int points) {
  const int rows = 4 * points;
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(rows, states + points);
  J.leftCols(states) = randomMatrix(random, rows, states);
  for (int p = 0; p < points; ++p) J.block(4 * p, states + p, 4, 1) = randomMatrix(random, 4, 1);
  const Eigen::VectorXd r = randomMatrix(random, rows, 1);
  Problem problem;
  problem.H_full = J.transpose() * J;
  problem.b_full = J.transpose() * r;
  problem.system.H = problem.H_full.topLeftCorner(states, states);
  problem.system.b = problem.b_full.head(states);
  problem.system.V = problem.H_full.bottomLeftCorner(points, states);
  problem.system.H_depth = problem.H_full.diagonal().tail(points);
  problem.system.b_depth = problem.b_full.tail(points);
  return problem;
}

TEST(SchurComplement, StepEqualsDenseSolution) {
  test::Random random(1);
  for (const int states : {8, 24, 56, 120}) {
    const int points = 3 * states;
    const Problem problem = randomProblem(random, states, points);
    SchurComplement schur;
    ReducedSystem reduced;
    ReducedCameraSolver solver;
    for (const double lambda : {1.0, 1e-3, 0.0}) {  // in this order: damping must not accumulate
      schur.reduce(problem.system, lambda, reduced);
      Eigen::VectorXd x;
      ASSERT_TRUE(solver.solve(reduced.H, reduced.b, x));
      const Eigen::VectorXd d = schur.solveDepths(problem.system, x);
      Eigen::MatrixXd damped = problem.H_full;
      damped.diagonal() *= 1.0 + lambda;
      const Eigen::VectorXd expected = -damped.ldlt().solve(problem.b_full);
      EXPECT_LT((x - expected.head(states)).norm(), 1e-8 * expected.norm()) << states << " states, lambda " << lambda;
      EXPECT_LT((d - expected.tail(points)).norm(), 1e-8 * expected.norm()) << states << " states, lambda " << lambda;
    }
  }
}

TEST(SchurComplement, PointsWithoutInformationStay) {
  test::Random random(2);
  Problem problem = randomProblem(random, 8, 20);
  problem.system.V.row(3).setZero();
  problem.system.H_depth(3) = problem.system.b_depth(3) = 0.0;
  SchurComplement schur;
  ReducedSystem reduced;
  schur.reduce(problem.system, 0.0, reduced);
  EXPECT_TRUE(reduced.H.allFinite());
  EXPECT_EQ(schur.solveDepths(problem.system, Eigen::VectorXd::Ones(8))(3), 0.0);
}

/// Positive definite, block (0, n-1) and its like empty.
Eigen::MatrixXd banded(test::Random& random, int blocks) {
  const int n = 8 * blocks;
  Eigen::MatrixXd H = Eigen::MatrixXd::Identity(n, n);
  for (int k = 0; k + 1 < blocks; ++k) {
    const Eigen::MatrixXd J = randomMatrix(random, 16, 16);
    H.block(8 * k, 8 * k, 16, 16) += J.transpose() * J;
  }
  return H;
}

TEST(CholmodSolver, SolvesAndAnalysesOncePerStructure) {
  test::Random random(3);
  CholmodSolver solver(8);
  for (int i = 0; i < 3; ++i) {
    const Eigen::MatrixXd H = banded(random, 6);
    const Eigen::VectorXd b = randomMatrix(random, 48, 1);
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
  const Eigen::VectorXd b = randomMatrix(random, 48, 1);
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

TEST(MarginalizationPrior, KeepsTheMinimumOfTheJointProblem) {
  test::Random random(5);
  MarginalizationPrior prior;
  for (int i = 0; i < 4; ++i) prior.appendKeyframe();
  // States of very different units, as metres, radians and grey levels are.
  const Eigen::VectorXd units = Eigen::VectorXd::LinSpaced(32, -8.0, 8.0).array().exp();
  const Eigen::MatrixXd J = randomMatrix(random, 60, 32) * units.asDiagonal();
  const Eigen::MatrixXd H = J.transpose() * J;
  const Eigen::VectorXd b = J.transpose() * randomMatrix(random, 60, 1);
  prior.add(H, b);
  const Eigen::VectorXd joint = -(units.cwiseInverse().asDiagonal() * H * units.cwiseInverse().asDiagonal())
                                     .ldlt()
                                     .solve(units.cwiseInverse().asDiagonal() * b);
  prior.marginalize(1);
  ASSERT_EQ(prior.keyframes(), 3);
  Eigen::VectorXd kept_units(24), expected(24);
  kept_units << units.head(8), units.tail(16);
  expected << joint.head(8), joint.tail(16);
  const Eigen::VectorXd minimum =
      -(kept_units.cwiseInverse().asDiagonal() * prior.H() * kept_units.cwiseInverse().asDiagonal())
           .ldlt()
           .solve(kept_units.cwiseInverse().asDiagonal() * prior.b());
  EXPECT_LT((minimum - expected).norm(), 1e-8 * expected.norm());
  for (int k = 0; k < 3; ++k) EXPECT_TRUE(prior.connected(k));
}

TEST(MarginalizationPrior, KeyframeWithoutInformationLeavesNoTrace) {
  MarginalizationPrior prior;
  for (int i = 0; i < 2; ++i) prior.appendKeyframe();
  prior.addDiagonal(0, Vector8::Constant(4.0), Vector8::Constant(0.5));
  const Eigen::MatrixXd H = prior.H().topLeftCorner<8, 8>();
  prior.marginalize(1);
  EXPECT_LT((prior.H() - H).norm(), 1e-12);
  EXPECT_NEAR(prior.b()(0), 2.0, 1e-12);
  EXPECT_FALSE(prior.connected(0));
}

TEST(MarginalizationPrior, MovingTheLinearizationPointKeepsTheCost) {
  test::Random random(6);
  MarginalizationPrior prior;
  for (int i = 0; i < 2; ++i) prior.appendKeyframe();
  const Eigen::MatrixXd J = randomMatrix(random, 20, 16);
  prior.add(J.transpose() * J, randomMatrix(random, 16, 1));
  const Eigen::VectorXd d = randomMatrix(random, 16, 1);
  Eigen::VectorXd step = Eigen::VectorXd::Zero(16);
  step.tail(8) = randomMatrix(random, 8, 1);
  const double before = prior.cost(d);
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(16, 16);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(16), moved_gradient = gradient;
  prior.addTo(d, H, gradient);
  prior.moveLinearizationPoint(1, step.tail<8>());
  EXPECT_NEAR(prior.cost(d - step), before, 1e-9 * std::abs(before));
  prior.addTo(d - step, H, moved_gradient);
  EXPECT_LT((gradient - moved_gradient).norm(), 1e-9 * gradient.norm());
}

}  // namespace
}  // namespace mba_vo
