#include "mba_vo/evaluation/clock_offset.h"

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluation/synthetic_run.h"
#include "mba_vo/evaluation/evaluator.h"

namespace mba_vo::clock_offset_test {
namespace {

using testing::HasSubstr;

/// What a hand does: turns about all axes that never repeat themselves.
SE3 handHeldAt(double t) {
  const Eigen::Vector3d angles(0.3 * std::sin(2.1 * t + 1.0) + 0.1 * std::sin(5.3 * t * (1.0 + 0.02 * t)),
                               0.4 * std::sin(1.3 * t), 0.2 * std::sin(0.7 * t * (1.0 + 0.05 * t)));
  return {Eigen::Quaterniond(Eigen::AngleAxisd(angles.norm(), angles.normalized())),
          {std::sin(t), 0.3 * std::cos(1.7 * t), 0.1 * t}};
}

SE3 turningSteadilyAt(double t) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(0.5 * t, Eigen::Vector3d::UnitZ())), {std::sin(t), t, 0.0}};
}

SE3 shakenEverySecondAt(double t) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(0.2 * std::sin(2.0 * M_PI * t), Eigen::Vector3d::UnitZ())), {t, 0, 0}};
}

/// Stamps are `late` [s] after the time of the pose; rotations are wrong by `noise` [rad].
std::vector<PoseRecord> recorded(SE3 (*poseAt)(double), double rate, double begin, double end, double late,
                                 double noise = 0.0) {
  std::mt19937 generator(7);
  std::normal_distribution<double> normal(0.0, noise);
  std::vector<PoseRecord> poses;
  for (double t = begin; t < end; t += 1.0 / rate) {
    Vector6 error = Vector6::Zero();
    if (noise > 0.0) {
      for (int k = 3; k < 6; ++k) error(k) = normal(generator);
    }
    poses.push_back({t + late, poseAt(t) * SE3::exp(error), std::nullopt, 0});
  }
  return poses;
}

TEST(ClockOffset, IsFoundInOtherCoordinatesAtAnotherRateAndWithNoise) {
  const auto estimate = inOtherCoordinates(recorded(handHeldAt, 30.0, 3.0, 17.0, 0.0, 0.001), 2.5);
  for (const double late : {1.02, -0.43, 7.7}) {
    const auto truth = recorded(handHeldAt, 110.0, 0.0, 20.0, late, 0.001);
    const std::optional<double> offset = findClockOffset(truth, estimate, 0.0);
    ASSERT_TRUE(offset.has_value()) << late;
    EXPECT_NEAR(*offset, late, 0.004);
  }
}

TEST(ClockOffset, IsFoundAcrossGaps) {
  auto estimate = recorded(handHeldAt, 20.0, 3.0, 17.0, 0.0);
  estimate.erase(estimate.begin() + 100, estimate.begin() + 160);
  const std::optional<double> offset = findClockOffset(recorded(handHeldAt, 50.0, 0.0, 20.0, 1.5), estimate, 0.0);
  ASSERT_TRUE(offset.has_value());
  EXPECT_NEAR(*offset, 1.5, 0.004);
}

TEST(ClockOffset, IsFoundNearAGuess) {
  const auto estimate = recorded(handHeldAt, 30.0, 3.0, 17.0, 0.0);
  const std::optional<double> offset =
      findClockOffset(recorded(handHeldAt, 100.0, 0.0, 20.0, 1e9), estimate, 1e9 - 3.0);
  ASSERT_TRUE(offset.has_value());
  EXPECT_NEAR(*offset, 1e9, 0.004);
}

TEST(ClockOffset, IsNotMadeUp) {
  const auto estimate = recorded(handHeldAt, 30.0, 3.0, 17.0, 0.0, 0.001);
  EXPECT_FALSE(findClockOffset(recorded(handHeldAt, 100.0, 0.0, 20.0, 0.0, 0.001), estimate, 0.0)) << "clocks agree";
  EXPECT_FALSE(findClockOffset(recorded(handHeldAt, 100.0, 30.0, 60.0, -30.0), estimate, 0.0)) << "another motion";
  for (const auto poseAt : {turningSteadilyAt, shakenEverySecondAt}) {
    EXPECT_FALSE(findClockOffset(recorded(poseAt, 100.0, 0.0, 20.0, 0.3), recorded(poseAt, 30.0, 3.0, 17.0, 0.0), 0.0));
  }
  EXPECT_FALSE(findClockOffset({estimate[0], estimate[1]}, estimate, 0.0));
}

TEST(ClockOffset, IsOfferedWhereTruthIsASecondOff) {
  const auto estimate = recorded(handHeldAt, 30.0, 3.0, 17.0, 0.0);
  const auto hintOf = [&](double late) {
    return evaluateTrajectory(recorded(handHeldAt, 100.0, 0.0, 20.0, late), estimate, {}, {}).clock_hint;
  };
  EXPECT_THAT(hintOf(1.02), HasSubstr("the ground truth seems to be 1.02"));
  EXPECT_THAT(hintOf(1.02), HasSubstr(" s late: --time-offset 1.02"));
  EXPECT_THAT(hintOf(-1.02), HasSubstr(" s early: --time-offset -1.0"));
  EXPECT_EQ(hintOf(0.0), "");
}

}  // namespace
}  // namespace mba_vo::clock_offset_test
