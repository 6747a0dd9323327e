#include "mba_vo/trajectory/kinematic_blur.h"

#include <cmath>

#include <gtest/gtest.h>

#include "support/random.h"

namespace mba_vo {
namespace {

constexpr std::int64_t kInterval = 37'000'000;  // [ns]
constexpr double kExposure = 0.02;              // [s]

double seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

TEST(KinematicBlur, IsExactForConstantVelocityAndUnevenIntervals) {
  test::Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const Vector6 v = random.tangent(1.0, 3.0);
    const SE3 start = random.pose(1.0, 1.0);
    KinematicBlur blur;
    for (const std::int64_t ns : {0L, 20'000'000L, 75'000'000L, 110'000'000L})
      blur.add(ns, start * SE3::exp(seconds(ns) * v), v);
    EXPECT_LT((kExposure * blur.velocityOfMiddle() - kExposure * v).norm(), 1e-9);
    EXPECT_EQ((0.0 * blur.velocityOfMiddle()).norm(), 0.0);
  }
}

TEST(KinematicBlur, MeansTheVelocitiesOnBothSidesOfTheLastButOnePose) {
  const Vector6 before = (Vector6() << 0.4, 0, 0, 0, 2.0, 0).finished();
  const Vector6 after = (Vector6() << -0.2, 0, 0, 0, 1.0, 0).finished();
  KinematicBlur blur;
  blur.add(-kInterval, SE3::exp(-5.0 * before), std::nullopt);  // long forgotten
  const SE3 middle = SE3::exp(seconds(kInterval) * before);
  blur.add(0, SE3(), std::nullopt);
  blur.add(kInterval, middle, std::nullopt);
  blur.add(2 * kInterval, middle * SE3::exp(seconds(kInterval) * after), std::nullopt);
  EXPECT_LT((kExposure * blur.velocityOfMiddle() - kExposure * 0.5 * (before + after)).norm(), 1e-9);
}

TEST(KinematicBlur, LeavesOutASideThatIsTooFarAway) {
  const Vector6 v = (Vector6() << 0.1, 0.2, 0, 0.5, 0, 0).finished();
  KinematicBlur blur;
  blur.add(0, SE3::exp(9.0 * v), std::nullopt);  // a second before, somewhere else
  blur.add(1'000'000'000, SE3(), std::nullopt);
  EXPECT_EQ(blur.velocityOfMiddle().norm(), 0.0);
  blur.add(1'000'000'000 + kInterval, SE3::exp(seconds(kInterval) * v), std::nullopt);
  EXPECT_LT((kExposure * blur.velocityOfMiddle() - kExposure * v).norm(), 1e-9);
}

TEST(KinematicBlur, TheLastFrameHasItsOwnVelocityOrThatSinceTheOneBefore) {
  const Vector6 v = (Vector6() << 0.1, 0.2, 0, 0.5, 0, 0).finished();
  const Vector6 measured = 1.1 * v;
  KinematicBlur blur;
  EXPECT_EQ(blur.velocityOfLast().norm(), 0.0);
  blur.add(0, SE3(), std::nullopt);
  EXPECT_EQ(blur.velocityOfLast().norm(), 0.0);
  blur.add(kInterval, SE3::exp(seconds(kInterval) * v), std::nullopt);
  EXPECT_LT((blur.velocityOfLast() - v).norm(), 1e-9);
  blur.add(2 * kInterval, SE3::exp(seconds(2 * kInterval) * v), measured);
  EXPECT_EQ(blur.velocityOfLast(), measured);
  blur.add(2'000'000'000, SE3(), std::nullopt);
  EXPECT_EQ(blur.velocityOfLast().norm(), 0.0) << "too long ago";
}

TEST(KinematicBlur, IgnoresPosesThatAreNotLater) {
  const Vector6 v = (Vector6() << 0.1, 0.2, 0, 0.5, 0, 0).finished();
  KinematicBlur blur;
  EXPECT_EQ(blur.velocityOfMiddle().norm(), 0.0);
  blur.add(kInterval, SE3::exp(seconds(kInterval) * v), std::nullopt);
  EXPECT_EQ(blur.velocityOfMiddle().norm(), 0.0);
  blur.add(kInterval, SE3::exp(3.0 * v), std::nullopt);
  blur.add(0, SE3::exp(3.0 * v), std::nullopt);
  blur.add(2 * kInterval, SE3::exp(seconds(2 * kInterval) * v), std::nullopt);
  EXPECT_LT((kExposure * blur.velocityOfMiddle() - kExposure * v).norm(), 1e-9);
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
  KinematicBlur blur;
  for (const std::int64_t i : {-1, 0, 1}) {
    Vector6 velocity = Vector6::Zero();
    velocity(4) = turn.velocity(seconds(i * kInterval)) + common_error;
    blur.add(i * kInterval, turn.pose(seconds(i * kInterval)), velocity);
  }
  return kExposure * blur.velocityOfMiddle()(4);
}

TEST(KinematicBlur, MeasuredVelocitiesCorrectForChangesOfAcceleration) {
  const JerkyTurn turn{1.0, -20.0, 3000.0};
  EXPECT_NEAR(turnOfMiddle(turn, 0.0), kExposure * 1.0, 1e-9);
}

TEST(KinematicBlur, ACommonErrorOfTheMeasuredVelocitiesFades) {
  // A reference's error comes back through the velocities measured against it: it must come back smaller.
  const JerkyTurn turn{1.0, -20.0, 3000.0};
  const double error = turnOfMiddle(turn, 0.5) - turnOfMiddle(turn, 0.0);
  EXPECT_LT(std::abs(error), 0.5 * kExposure * 0.5);
}

}  // namespace
}  // namespace mba_vo
