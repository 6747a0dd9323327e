#include "mba_vo/solver/settled_points.h"

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include "mba_vo/solver/reduced_camera_solver.h"
#include "support/random.h"

namespace mba_vo::settled_points_test {
namespace {

/// A random least-squares problem: `states` camera states, `points` depths, each depth in four residuals of its own,
/// which only some of the keyframes have a part in: every `stride`-th, beginning with another one from point to point.
struct Problem {
  LinearizedWindow system;
  Eigen::MatrixXd H_full;
  Eigen::VectorXd b_full;
};

Problem randomProblem(test::Random& random, int states, int points, int stride = 1) {
  const int rows = 4 * points;
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(rows, states + points);
  for (int p = 0; p < points; ++p) {
    J.block(4 * p, states + p, 4, 1) = random.matrix(4, 1);
    for (int k = p % stride; 8 * k < states; k += stride) J.block(4 * p, 8 * k, 4, 8) = random.matrix(4, 8);
  }
  const Eigen::VectorXd r = random.matrix(rows, 1);
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
    const Problem problem = randomProblem(random, states, points, states > 100 ? 4 : 1);
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

/// Only the rows of the points that are chosen, and the keyframes' part of these.
LinearizedWindow partOf(const Problem& problem, const std::vector<bool>& chosen, test::Random& random) {
  LinearizedWindow part = problem.system;
  // Of a sum of squares any part will do, as long as what is left is one as well.
  const Eigen::Index states = part.b.size();
  part.H *= 0.25;
  part.b = 0.25 * part.b + 0.01 * random.matrix(static_cast<int>(states), 1);
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (!chosen[i]) continue;
    const auto from = static_cast<Eigen::Index>(i);
    part.V.row(row) = problem.system.V.row(from);
    part.H_depth(row) = problem.system.H_depth(from);
    part.b_depth(row++) = problem.system.b_depth(from);
  }
  part.V.conservativeResize(row, states);
  part.H_depth.conservativeResize(row);
  part.b_depth.conservativeResize(row);
  return part;
}

/// A third of the points go on to be evaluated; the others are what they were when they settled.
class SettledPointsTest : public testing::Test {
 protected:
  static constexpr int kStates = 24;
  static constexpr int kPoints = 60;

  SettledPointsTest() : problem_(randomProblem(random_, kStates, kPoints)), settles_(kPoints) {
    std::vector<bool> others(kPoints);
    for (std::size_t i = 0; i < settles_.size(); ++i) {
      settles_[i] = i % 3 != 0;
      others[i] = !settles_[i];
    }
    others_ = partOf(problem_, others, random_);
    LinearizedWindow all = problem_.system;
    settled_.settle(all, settles_, others_);
  }

  /// Of all points, from where the keyframe states are `moved` by now and the depths are best for them.
  Eigen::VectorXd stepOfTheRest(const Eigen::VectorXd& moved) {
    LinearizedWindow system = others_;
    system.b += others_.H * moved;
    system.b_depth += others_.V * moved;
    settled_.addTo(system.H, system.b);
    ReducedSystem reduced;
    SchurComplement().reduce(system, 0.0, reduced);
    Eigen::VectorXd step;
    EXPECT_TRUE(ReducedCameraSolver().solve(reduced.H, reduced.b, step));
    return step;
  }

  test::Random random_{3};
  Problem problem_;
  std::vector<bool> settles_;
  LinearizedWindow others_;
  SettledPoints settled_;
};

TEST_F(SettledPointsTest, TheStepIsThatOfAllPoints) {
  const Eigen::VectorXd expected = -problem_.H_full.ldlt().solve(problem_.b_full);
  EXPECT_LT((stepOfTheRest(Eigen::VectorXd::Zero(kStates)) - expected.head(kStates)).norm(), 1e-8 * expected.norm());
}

TEST_F(SettledPointsTest, HavingMovedTheyWantTheRestOfTheStep) {
  const Eigen::VectorXd step = -problem_.H_full.ldlt().solve(problem_.b_full).head(kStates);
  const Eigen::VectorXd part = 0.3 * step + 0.01 * random_.matrix(kStates, 1);
  settled_.move(part);
  EXPECT_LT((stepOfTheRest(part) - (step - part)).norm(), 1e-8 * step.norm());
}

TEST_F(SettledPointsTest, DepthsAndCostAreThoseThatSuitTheKeyframesBest) {
  const Eigen::VectorXd moved = 0.1 * random_.matrix(kStates, 1);
  settled_.move(moved);
  const Eigen::VectorXd steps = settled_.depthSteps();
  // Of the whole problem, less that of the others, which stay.
  LinearizedWindow only = problem_.system;
  only.H -= others_.H;
  only.b -= others_.b;
  double expected = moved.dot(only.H * moved + 2.0 * only.b);
  for (int i = 0; i < kPoints; ++i) {
    if (!settles_[static_cast<std::size_t>(i)]) {
      EXPECT_EQ(steps(i), 0.0);
      continue;
    }
    const double gradient = only.b_depth(i) + only.V.row(i).dot(moved);
    EXPECT_NEAR(steps(i), -gradient / only.H_depth(i), 1e-12);
    expected += steps(i) * (only.H_depth(i) * steps(i) + 2.0 * gradient);
  }
  EXPECT_NEAR(settled_.costChange(), expected, 1e-9 * std::abs(expected));
}

TEST_F(SettledPointsTest, NoneSayNothing) {
  settled_.clear();
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(kStates, kStates);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(kStates);
  settled_.addTo(H, b);
  EXPECT_TRUE(H.isZero(0.0) && b.isZero(0.0));
  EXPECT_EQ(settled_.costChange(), 0.0);
}

}  // namespace
}  // namespace mba_vo::settled_points_test
