#include "mba_vo/solver/levenberg_marquardt.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mba_vo/solver/robust_loss.h"

namespace mba_vo::levenberg_marquardt_test {
namespace {

/// Rosenbrock's valley as two residuals.
struct Valley {
  static constexpr int kStates = 2;
  using State = Eigen::Vector2d;

  NormalEquations<2> linearize(const State& x) const {
    const Eigen::Vector2d r(10.0 * (x(1) - x(0) * x(0)), 1.0 - x(0));
    Eigen::Matrix2d J;
    J << -20.0 * x(0), 10.0, -1.0, 0.0;
    return {J.transpose() * J, J.transpose() * r, 0.5 * r.squaredNorm()};
  }
  bool refresh(const State&) { return false; }
  static State plus(const State& x, const Eigen::Vector2d& step) { return x + step; }
  static double stepSize(const Eigen::Vector2d& step) { return step.norm(); }
};

LevenbergMarquardtOptions precise() {
  LevenbergMarquardtOptions options;
  options.max_iterations = 200;
  options.relative_decrease = 0.0;
  options.min_step = 1e-12;
  options.max_rejections = 20;
  return options;
}

TEST(LevenbergMarquardt, FindsTheEndOfTheValley) {
  Valley valley;
  const auto summary = minimize(valley, Eigen::Vector2d(-1.2, 1.0), precise());
  EXPECT_LT((summary.state - Eigen::Vector2d(1.0, 1.0)).norm(), 1e-8);
  EXPECT_LT(summary.equations.cost, 1e-15);
}

TEST(LevenbergMarquardt, NeverAcceptsAHigherCost) {
  Valley valley;
  double last = valley.linearize(Eigen::Vector2d(-1.2, 1.0)).cost;
  for (int iterations = 2; iterations < 40; ++iterations) {
    LevenbergMarquardtOptions options = precise();
    options.max_iterations = iterations;
    const double cost = minimize(valley, Eigen::Vector2d(-1.2, 1.0), options).equations.cost;
    EXPECT_LE(cost, last);
    last = cost;
  }
}

TEST(LevenbergMarquardt, StepsThatPromiseLittleAreNotTried) {
  Valley valley;
  LevenbergMarquardtOptions options = precise();
  const Eigen::Vector2d nearly(1.001, 1.002);
  ASSERT_GT(minimize(valley, nearly, options).accepted, 0);
  options.promised_decrease = 2.0;  // more than there is
  const auto summary = minimize(valley, nearly, options);
  EXPECT_EQ(summary.iterations, 1);
  EXPECT_EQ(summary.state, nearly);
}

TEST(LevenbergMarquardt, AShortStepThatWasTriedIsTheLast) {
  Valley valley;
  LevenbergMarquardtOptions options = precise();
  const Eigen::Vector2d nearly(1.001, 1.002);
  ASSERT_GT(minimize(valley, nearly, options).accepted, 1);
  options.last_step = 1.0;  // longer than any
  const auto summary = minimize(valley, nearly, options);
  EXPECT_EQ(summary.accepted, 1);
  EXPECT_EQ(summary.iterations, 2);
}

/// Refuses every step.
struct Refusal : Valley {
  Eigen::Vector2d first;
  NormalEquations<2> linearize(const State& x) const {
    NormalEquations<2> equations = Valley::linearize(x);
    if (x != first) equations.cost = 1e9;
    return equations;
  }
};

TEST(LevenbergMarquardt, AShortStepThatIsRefusedIsNotTriedOnceMore) {
  Refusal refusal{{}, {-1.2, 1.0}};
  LevenbergMarquardtOptions options = precise();
  options.max_rejections = 4;
  EXPECT_EQ(minimize(refusal, refusal.first, options).iterations, 5);
  options.last_step = 100.0;  // longer than any
  const auto summary = minimize(refusal, refusal.first, options);
  EXPECT_EQ(summary.iterations, 2);
  EXPECT_EQ(summary.state, refusal.first);
}

TEST(LevenbergMarquardt, AStepThatDampingMadeShortIsNotTheLast) {
  Refusal refusal{{}, {-1.2, 1.0}};
  LevenbergMarquardtOptions options = precise();
  options.max_rejections = 6;
  options.damping_increase = 1e3;
  options.last_step = 1.0;  // the first step is longer
  EXPECT_EQ(minimize(refusal, refusal.first, options).iterations, 7);
}

TEST(NormalEquations, FixedStatesDoNotMove) {
  NormalEquations<3> equations;
  equations.hessian << 4, 1, 1, 1, 3, 0.5, 1, 0.5, 2;
  equations.gradient << 1, 2, 3;
  equations.fix(1, 1);
  const Eigen::Vector3d step = -equations.hessian.ldlt().solve(equations.gradient);
  EXPECT_EQ(step(1), 0.0);
  const Eigen::Vector2d reduced = -(Eigen::Matrix2d() << 4, 1, 1, 2).finished().ldlt().solve(Eigen::Vector2d(1, 3));
  EXPECT_NEAR(step(0), reduced(0), 1e-12);
  EXPECT_NEAR(step(2), reduced(1), 1e-12);
}

TEST(NormalEquations, PriorIsAQuadratic) {
  NormalEquations<2> equations;
  equations.addPrior<2>(0, Eigen::Vector2d(0.5, -1.0), Eigen::Vector2d(2.0, 3.0));
  EXPECT_NEAR(equations.cost, 0.5 * (2.0 * 0.25 + 3.0), 1e-12);
  const Eigen::Vector2d step = -equations.hessian.ldlt().solve(equations.gradient);
  EXPECT_LT((step - Eigen::Vector2d(-0.5, 1.0)).norm(), 1e-12);
}

TEST(HuberLoss, CostIsContinuousAndWeightIsItsDerivative) {
  const HuberLoss loss(3.0);
  EXPECT_NEAR(loss.cost(3.0), loss.cost(3.0 + 1e-9), 1e-7);
  for (const double r : {-20.0, -3.5, -1.0, 0.5, 2.9, 3.1, 50.0}) {
    const double derivative = (loss.cost(r + 1e-6) - loss.cost(r - 1e-6)) / 2e-6;
    EXPECT_NEAR(loss.weight(r) * r, derivative, 1e-6);
  }
}

}  // namespace
}  // namespace mba_vo::levenberg_marquardt_test
