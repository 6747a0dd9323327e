#include "mba_vo/trajectory/finite_difference_velocity.h"

#include <cmath>

#include <gtest/gtest.h>

#include "support/random.h"

namespace mba_vo::finite_difference_velocity_test {
namespace {

constexpr std::int64_t kInterval = 37'000'000;  // [ns]
constexpr double kExposure = 0.02;              // [s]

double seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

TEST(FiniteDifferenceVelocity, IsExactForConstantVelocityAndUnevenIntervals) {
  test::Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const Vector6 v = random.tangent(1.0, 3.0);
    const SE3 start = random.pose(1.0, 1.0);
    FiniteDifferenceVelocity motion;
    for (const std::int64_t ns : {0L, 20'000'000L, 75'000'000L, 110'000'000L})
      motion.add(ns, start * SE3::exp(seconds(ns) * v), ObservedMotion{v, std::nullopt});
    EXPECT_LT((kExposure * motion.velocityOfMiddle() - kExposure * v).norm(), 1e-9);
    EXPECT_EQ((0.0 * motion.velocityOfMiddle()).norm(), 0.0);
  }
}

TEST(FiniteDifferenceVelocity, MeansTheVelocitiesOnBothSidesOfTheLastButOnePose) {
  const Vector6 before = (Vector6() << 0.4, 0, 0, 0, 2.0, 0).finished();
  const Vector6 after = (Vector6() << -0.2, 0, 0, 0, 1.0, 0).finished();
  FiniteDifferenceVelocity motion;
  motion.add(-kInterval, SE3::exp(-5.0 * before), std::nullopt);  // long forgotten
  const SE3 middle = SE3::exp(seconds(kInterval) * before);
  motion.add(0, SE3(), std::nullopt);
  motion.add(kInterval, middle, std::nullopt);
  motion.add(2 * kInterval, middle * SE3::exp(seconds(kInterval) * after), std::nullopt);
  EXPECT_LT((kExposure * motion.velocityOfMiddle() - kExposure * 0.5 * (before + after)).norm(), 1e-9);
}

TEST(FiniteDifferenceVelocity, LeavesOutASideThatIsTooFarAway) {
  const Vector6 v = (Vector6() << 0.1, 0.2, 0, 0.5, 0, 0).finished();
  FiniteDifferenceVelocity motion;
  motion.add(0, SE3::exp(9.0 * v), std::nullopt);  // a second before, somewhere else
  motion.add(1'000'000'000, SE3(), std::nullopt);
  EXPECT_EQ(motion.velocityOfMiddle().norm(), 0.0);
  motion.add(1'000'000'000 + kInterval, SE3::exp(seconds(kInterval) * v), std::nullopt);
  EXPECT_LT((kExposure * motion.velocityOfMiddle() - kExposure * v).norm(), 1e-9);
}

TEST(FiniteDifferenceVelocity, TheLastFrameMovesAsSinceTheOneBeforeOrAsItsRowsSay) {
  const Vector6 v = (Vector6() << 0.1, 0.2, 0, 0.5, 0, 0).finished();
  const Vector6 measured = 1.1 * v;
  FiniteDifferenceVelocity motion;
  EXPECT_EQ(motion.motionOfLast().velocity.norm(), 0.0);
  motion.add(0, SE3(), ObservedMotion{measured, std::nullopt});
  EXPECT_EQ(motion.motionOfLast().velocity, measured) << "there is nothing else";
  motion.add(kInterval, SE3::exp(seconds(kInterval) * v), ObservedMotion{measured, std::nullopt});
  EXPECT_LT((motion.motionOfLast().velocity - v).norm(), 1e-9);
  motion.add(2 * kInterval, SE3::exp(seconds(2 * kInterval) * v), ObservedMotion{measured, Eigen::Vector3d(1, 2, 3)});
  EXPECT_EQ(motion.motionOfLast().velocity, measured);
  EXPECT_EQ(motion.motionOfLast().acceleration, (Vector6() << 0, 0, 0, 1, 2, 3).finished());
  motion.add(2'000'000'000, SE3(), std::nullopt);
  EXPECT_EQ(motion.motionOfLast().velocity.norm(), 0.0) << "too long ago";
}

TEST(FiniteDifferenceVelocity, IgnoresPosesThatAreNotLater) {
  const Vector6 v = (Vector6() << 0.1, 0.2, 0, 0.5, 0, 0).finished();
  FiniteDifferenceVelocity motion;
  EXPECT_EQ(motion.velocityOfMiddle().norm(), 0.0);
  motion.add(kInterval, SE3::exp(seconds(kInterval) * v), std::nullopt);
  EXPECT_EQ(motion.velocityOfMiddle().norm(), 0.0);
  motion.add(kInterval, SE3::exp(3.0 * v), std::nullopt);
  motion.add(0, SE3::exp(3.0 * v), std::nullopt);
  motion.add(2 * kInterval, SE3::exp(seconds(2 * kInterval) * v), std::nullopt);
  EXPECT_LT((kExposure * motion.velocityOfMiddle() - kExposure * v).norm(), 1e-9);
}

/// Rotation about one axis, whose rate is a parabola in time.
struct JerkyTurn {
  double rate, acceleration, jerk;
  double velocity(double t) const { return rate + acceleration * t + 0.5 * jerk * t * t; }
  SE3 pose(double t) const {
    Vector6 turn = Vector6::Zero();
    turn(4) = rate * t + acceleration * t * t / 2 + jerk * t * t * t / 6;
    return SE3::exp(turn);
  }
};

double turnOfMiddle(const JerkyTurn& turn, double common_error) {
  FiniteDifferenceVelocity motion;
  for (const std::int64_t i : {-1, 0, 1}) {
    Vector6 velocity = Vector6::Zero();
    velocity(4) = turn.velocity(seconds(i * kInterval)) + common_error;
    motion.add(i * kInterval, turn.pose(seconds(i * kInterval)), ObservedMotion{velocity, std::nullopt});
  }
  return kExposure * motion.velocityOfMiddle()(4);
}

TEST(FiniteDifferenceVelocity, MeasuredVelocitiesCorrectForChangesOfAcceleration) {
  const JerkyTurn turn{1.0, -20.0, 500.0};
  EXPECT_NEAR(turnOfMiddle(turn, 0.0), kExposure * 1.0, 1e-9);
}

TEST(FiniteDifferenceVelocity, TheAccelerationIsThatOfAConstantOne) {
  const JerkyTurn turn{1.0, -20.0, 0.0};
  FiniteDifferenceVelocity motion;
  EXPECT_EQ(motion.motionOfMiddle().acceleration.norm(), 0.0);
  for (const double step : {-1.0, 0.0, 1.5}) {
    const auto ns = static_cast<std::int64_t>(step * static_cast<double>(kInterval));
    EXPECT_EQ(motion.motionOfMiddle().acceleration.norm(), 0.0) << "fewer than three poses";
    motion.add(ns, turn.pose(seconds(ns)), std::nullopt);
  }
  EXPECT_NEAR(motion.motionOfMiddle().acceleration(4), turn.acceleration, 1e-6);
  EXPECT_EQ(motion.motionOfMiddle().velocity, motion.velocityOfMiddle());
  motion.add(2'000'000'000, SE3(), std::nullopt);
  EXPECT_EQ(motion.motionOfMiddle().acceleration.norm(), 0.0) << "too long ago";
}

TEST(FiniteDifferenceVelocity, HalfOfATurnsAccelerationIsWhatTheRowsTell) {
  const JerkyTurn turn{1.0, -20.0, 0.0};
  FiniteDifferenceVelocity motion;
  const Eigen::Vector3d told(5.0, -30.0, 0.0);
  for (const std::int64_t i : {-1, 0, 1}) {
    motion.add(i * kInterval, turn.pose(seconds(i * kInterval)), ObservedMotion{Vector6::Zero(), told});
  }
  const Vector6 expected = (Vector6() << 0, 0, 0, 2.5, -25.0, 0).finished();
  EXPECT_LT((motion.motionOfMiddle().acceleration - expected).norm(), 1e-6);
}

TEST(FiniteDifferenceVelocity, ACommonErrorOfTheMeasuredVelocitiesFades) {
  // A reference's error comes back through the velocities measured against it: it must come back smaller.
  const JerkyTurn turn{1.0, -20.0, 500.0};
  const double error = turnOfMiddle(turn, 0.5) - turnOfMiddle(turn, 0.0);
  EXPECT_LT(std::abs(error), 0.5 * kExposure * 0.5);
}

/// A turn that gets faster; velocities measured with errors, of the frame before and the last one.
FiniteDifferenceVelocity followed(const JerkyTurn& turn, double error_before, double error_of_last) {
  FiniteDifferenceVelocity motion;
  for (const std::int64_t i : {-2, -1, 0}) {
    Vector6 velocity = Vector6::Zero();
    velocity(4) = turn.velocity(seconds(i * kInterval)) + (i == 0 ? error_of_last : error_before);
    motion.add(i * kInterval, turn.pose(seconds(i * kInterval)), ObservedMotion{velocity, std::nullopt});
  }
  return motion;
}

Vector6 velocityOfLast(const JerkyTurn& turn, double error_before, double error_of_last) {
  return followed(turn, error_before, error_of_last).motionOfLast().velocity;
}

TEST(FiniteDifferenceVelocity, TheLastFrameHasGainedWhatWasMeasured) {
  const JerkyTurn turn{1.0, 20.0, 0.0};
  EXPECT_NEAR(velocityOfLast(turn, 0.0, 0.0)(4), 1.0, 1e-9);
  EXPECT_NEAR(velocityOfLast(turn, 0.5, 0.5)(4), 1.0, 1e-9) << "an error of the reference is in both";
}

TEST(FiniteDifferenceVelocity, WhatIsMeasuredIsBelievedAsFarAsPosesAllow) {
  const JerkyTurn turn{1.0, 20.0, 0.0};
  constexpr double kMost = 550.0 * 0.037 * 0.037;  // [rad/s] by which a turn may change its acceleration
  EXPECT_NEAR(velocityOfLast(turn, 0.0, -5.0)(4), 1.0 - kMost / 4.0, 1e-6) << "blur does not tell v from -v";
  FiniteDifferenceVelocity motion;
  for (const std::int64_t i : {-1, 0, 1}) {
    Vector6 velocity = Vector6::Zero();
    velocity(4) = i == 0 ? -5.0 : turn.velocity(seconds(i * kInterval));
    motion.add(i * kInterval, turn.pose(seconds(i * kInterval)), ObservedMotion{velocity, std::nullopt});
  }
  EXPECT_NEAR(motion.velocityOfMiddle()(4), 1.0 - kMost / 6.0, 1e-6);
}

TEST(FiniteDifferenceVelocity, TheBestGuessOfATurnListensToTheBlurToo) {
  const JerkyTurn turn{1.0, 20.0, 400.0};
  const double by_gain = velocityOfLast(turn, 0.0, 0.0)(4) - 1.0;
  const double best = followed(turn, 0.0, 0.0).bestOfLast().velocity(4) - 1.0;
  EXPECT_LT(std::abs(best), 0.6 * std::abs(by_gain)) << "the acceleration changes";
  constexpr double kMost = 550.0 * 0.037 * 0.037;
  const JerkyTurn even{1.0, 20.0, 0.0};
  EXPECT_NEAR(followed(even, 0.0, -5.0).bestOfLast().velocity(4), 1.0 - 0.375 * kMost, 1e-6) << "as far as poses allow";
}

TEST(FiniteDifferenceVelocity, TheBestGuessOfAWayIsThatOfThePosesWhateverIsMeasured) {
  constexpr double kAcceleration = 3.0;  // [m/s^2]
  for (const bool by_rows : {false, true}) {
    FiniteDifferenceVelocity motion;
    for (const std::int64_t i : {-2, -1, 0}) {
      const double t = seconds(i * kInterval);
      const SE3 pose(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.5 * kAcceleration * t * t + 0.4 * t, 0.0, 0.0));
      ObservedMotion wrong{Vector6::Constant(0.7), std::nullopt};
      if (by_rows) wrong.angular_acceleration = Eigen::Vector3d(1.0, 2.0, 3.0);
      motion.add(i * kInterval, pose, wrong);
    }
    const double gained = kAcceleration * seconds(kInterval);
    EXPECT_NEAR(motion.bestOfLast().velocity(0), 0.4 - gained / 2.0 + gained / 3.0, 1e-9);
    EXPECT_EQ(motion.bestOfLast().velocity.tail<3>() == Eigen::Vector3d::Constant(0.7), by_rows) << "rows are believed";
  }
}

TEST(FiniteDifferenceVelocity, WithoutAFrameBeforeThereIsNothingBetter) {
  FiniteDifferenceVelocity motion;
  EXPECT_FALSE(motion.knowsBefore());
  EXPECT_EQ(motion.bestOfLast().velocity, Vector6::Zero());
  motion.add(0, SE3(), ObservedMotion{Vector6::Constant(0.7), std::nullopt});
  EXPECT_FALSE(motion.knowsBefore());
  EXPECT_EQ(motion.bestOfLast().velocity, motion.motionOfLast().velocity);
  motion.add(kInterval, SE3(), std::nullopt);
  EXPECT_TRUE(motion.knowsBefore());
  motion.add(2'000'000'000, SE3(), std::nullopt);
  EXPECT_FALSE(motion.knowsBefore()) << "too long ago";
}

}  // namespace
}  // namespace mba_vo::finite_difference_velocity_test
