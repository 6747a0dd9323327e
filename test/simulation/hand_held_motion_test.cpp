#include "mba_vo/simulation/hand_held_motion.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace mba_vo::hand_held_motion_test {
namespace {

/// Errors of the constant-velocity guess by rotation matrices and their trace [deg], sorted.
std::vector<double> sortedErrors(const HandHeldMotion& motion, double duration) {
  std::vector<double> errors;
  const double dt = 1.0 / 27.0;
  for (double t = 2.0 * dt; t <= duration; t += dt) {
    const Eigen::Matrix3d a = motion.pose(t - 2.0 * dt).rotationMatrix();
    const Eigen::Matrix3d b = motion.pose(t - dt).rotationMatrix();
    const Eigen::Matrix3d c = motion.pose(t).rotationMatrix();
    const Eigen::Matrix3d error = (b * a.transpose() * b).transpose() * c;
    errors.push_back(std::acos(std::clamp(0.5 * (error.trace() - 1.0), -1.0, 1.0)) * 180.0 / M_PI);
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}

TEST(HandHeldMotion, ShakesAtLeastAsMuchAsPromised) {
  for (const int seed : {1, 2, 3, 4}) {
    for (const double duration : {8.0, 20.0}) {
      const HandHeldMotion motion({seed, duration, 1.0, 0.0}, FreeSpace{});
      const std::vector<double> errors = sortedErrors(motion, duration);
      EXPECT_GE(errors[errors.size() / 2], 0.5) << "seed " << seed;
      EXPECT_GE(errors[errors.size() * 9 / 10], 1.1);
      EXPECT_GE(errors.back(), 2.1);
      EXPECT_LE(errors[errors.size() / 2], 0.9);
      EXPECT_LE(errors.back(), 3.5);
    }
  }
}

TEST(HandHeldMotion, ErrorsOfTheLibraryAgreeWithTheTest) {
  const HandHeldMotion motion({5, 6.0, 1.0, 0.0}, FreeSpace{});
  std::vector<SE3> poses;
  for (double t = 0.0; t <= 6.0; t += 1.0 / 27.0) poses.push_back(motion.pose(t));
  std::vector<double> errors = constantVelocityErrors(poses);
  std::sort(errors.begin(), errors.end());
  const std::vector<double> expected = sortedErrors(motion, 6.0);
  ASSERT_EQ(errors.size(), expected.size());
  for (std::size_t i = 0; i < errors.size(); ++i) EXPECT_NEAR(errors[i], expected[i], 1e-5);
}

TEST(HandHeldMotion, ShakeScalesAndZeroIsSmooth) {
  const auto median = [](double shake) {
    const auto errors = sortedErrors(HandHeldMotion({1, 10.0, shake, 0.0}, FreeSpace{}), 10.0);
    return errors[errors.size() / 2];
  };
  EXPECT_LT(median(0.0), 0.05);
  EXPECT_NEAR(median(2.0) / median(1.0), 2.0, 0.3);
}

TEST(HandHeldMotion, StaysInsideAndKeepsAWalkersSpeed) {
  const FreeSpace space;
  for (const int seed : {1, 2, 3}) {
    const HandHeldMotion motion({seed, 20.0, 1.0, 0.0}, space);
    double length = 0.0;
    for (double t = 0.0; t < 20.0; t += 0.01) {
      const Eigen::Vector3d p = motion.pose(t).translation();
      length += (motion.pose(t + 0.01).translation() - p).norm();
      // The hand sways a little about the walk.
      EXPECT_TRUE(((p - space.center).array().abs() <= space.half_size.array() + 0.1).all()) << p.transpose();
    }
    EXPECT_NEAR(length / 20.0, 0.4, 0.02);
  }
}

TEST(HandHeldMotion, WalksTheLengthAskedForOrSaysWhatItCan) {
  const HandHeldMotion motion({3, 10.0, 0.5, 6.0}, FreeSpace{});
  double length = 0.0;
  for (int i = 0; i < 1000; ++i)
    length += (motion.pose(0.01 * (i + 1)).translation() - motion.pose(0.01 * i).translation()).norm();
  EXPECT_NEAR(length, 6.0, 0.1);
  try {
    const HandHeldMotion impossible({3, 1.0, 1.0, 500.0}, FreeSpace{});
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("path_length = 500"), std::string::npos) << error.what();
  }
}

TEST(HandHeldMotion, VelocityIsContinuous) {
  const HandHeldMotion motion({2, 10.0, 1.0, 0.0}, FreeSpace{});
  const double h = 1e-3;
  const auto velocity = [&](double t) -> Vector6 {
    return (motion.pose(t - h).inverse() * motion.pose(t + h)).log() / (2.0 * h);
  };
  // A kink or jump would show as an acceleration that grows without bound as the interval shrinks.
  for (double t = 0.0; t < 10.0; t += 0.0137) {
    const Vector6 acceleration = (velocity(t + h) - velocity(t - h)) / (2.0 * h);
    EXPECT_LT(acceleration.head<3>().norm(), 8.0) << t;
    EXPECT_LT(acceleration.tail<3>().norm(), 80.0) << t;
    const Vector6 finer = (velocity(t + 0.5 * h) - velocity(t - 0.5 * h)) / h;
    EXPECT_LT((finer - acceleration).norm(), 0.02 * (1.0 + acceleration.norm())) << t;
  }
}

}  // namespace
}  // namespace mba_vo::hand_held_motion_test
