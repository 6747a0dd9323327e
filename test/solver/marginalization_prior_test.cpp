#include "mba_vo/solver/marginalization_prior.h"

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include "support/random.h"

namespace mba_vo::marginalization_prior_test {
namespace {

TEST(MarginalizationPrior, KeepsTheMinimumOfTheJointProblem) {
  test::Random random(5);
  MarginalizationPrior prior;
  for (int i = 0; i < 4; ++i) prior.appendKeyframe();
  // States of very different units, as metres, radians and grey levels are.
  const Eigen::VectorXd units = Eigen::VectorXd::LinSpaced(32, -8.0, 8.0).array().exp();
  const Eigen::MatrixXd J = random.matrix(60, 32) * units.asDiagonal();
  const Eigen::MatrixXd H = J.transpose() * J;
  const Eigen::VectorXd b = J.transpose() * random.matrix(60, 1);
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

TEST(MarginalizationPrior, FollowsTheCalibrationAsTheJointProblemWould) {
  test::Random random(7);
  MarginalizationPrior prior;
  for (int i = 0; i < 3; ++i) prior.appendKeyframe();
  const Eigen::MatrixXd J = random.matrix(60, 24);
  const CalibrationCoupling coupling = random.matrix(24, CalibrationCorrection::kDim);
  prior.add(J.transpose() * J, random.matrix(24, 1));
  prior.addCalibrationCoupling(coupling);
  const CalibrationCorrection::Vector step = random.matrix(CalibrationCorrection::kDim, 1);
  MarginalizationPrior corrected_first = prior;
  corrected_first.correctCalibration(step);
  EXPECT_LT((corrected_first.b() - prior.b() - coupling * step).norm(), 1e-12 * prior.b().norm());
  corrected_first.marginalize(1);
  prior.marginalize(1);
  const Eigen::VectorXd before = prior.b();
  prior.correctCalibration(step);
  EXPECT_GT((prior.b() - before).norm(), 0.1 * before.norm());
  EXPECT_LT((prior.b() - corrected_first.b()).norm(), 1e-9 * before.norm());
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
  const Eigen::MatrixXd J = random.matrix(20, 16);
  prior.add(J.transpose() * J, random.matrix(16, 1));
  const Eigen::VectorXd d = random.matrix(16, 1);
  Eigen::VectorXd step = Eigen::VectorXd::Zero(16);
  step.tail(8) = random.matrix(8, 1);
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
}  // namespace mba_vo::marginalization_prior_test
