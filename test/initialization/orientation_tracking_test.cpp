#include "mba_vo/initialization/orientation_tracking.h"

#include <cmath>

#include <gtest/gtest.h>

#include "support/rendered_room.h"

namespace mba_vo::orientation_tracking_test {
namespace {

constexpr double kExposure = 0.01;  // [s]
constexpr double kInterval = 0.04;  // [s]
constexpr int kCount = 30;          // frames, in which the camera turns by about 90 degrees

SE3 turned(double yaw, double pitch) {
  Vector6 turn = Vector6::Zero();
  turn(3) = pitch;
  turn(4) = yaw;
  return SE3::exp(turn);
}

/// Turning and shaking on the spot.
SE3 turning(double t) { return turned(1.3 * t + 0.04 * std::sin(9.0 * t), 0.06 * std::sin(7.0 * t)); }

SimulatedFrame render(int index, double exposure = kExposure) {
  const SE3 T_world_start = test::roomSimulator().pose(1.0);
  const double t = kInterval * index;
  return test::roomSimulator().renderExposure([&](double at) { return T_world_start * turning(at); }, t, exposure,
                                              static_cast<std::uint64_t>(index));
}

FrameConstPtr frameOf(const SimulatedFrame& rendered, int index, double exposure = kExposure) {
  return test::makeFrame(test::toFloat(rendered.blurred), std::llround(1e9 * kInterval * index), exposure,
                         static_cast<std::uint64_t>(index));
}

/// Of the camera, in its own axes [rad/s].
Eigen::Vector3d angularVelocity(double t) {
  constexpr double kStep = 1e-4;  // [s]
  return (turning(t - kStep).inverse() * turning(t + kStep)).log().tail<3>() / (2.0 * kStep);
}

double degreesBetween(const SE3& a, const SE3& b) { return a.rotation().angularDistance(b.rotation()) * 180.0 / M_PI; }

TEST(OrientationTracking, FollowsACameraThatOnlyTurns) {
  OrientationTracking orientation((TrackerConfig()));
  double total_turn = 0.0;  // [deg]
  for (int i = 0; i < kCount; ++i) {
    EXPECT_TRUE(orientation.track(frameOf(render(i), i))) << "frame " << i;
    const SE3 truth = turning(0.0).inverse() * turning(kInterval * i);
    EXPECT_LT(degreesBetween(orientation.last().T_reference_mid, truth), 0.3) << "frame " << i;
    EXPECT_EQ(orientation.last().T_reference_mid.translation().norm(), 0.0);
    EXPECT_EQ(orientation.last().velocity.head<3>().norm(), 0.0);
    total_turn = degreesBetween(SE3(), truth);
  }
  EXPECT_GT(total_turn, 60.0) << "it has to change its reference several times";
  const double sigma = std::sqrt(orientation.covariance().trace());
  EXPECT_GT(sigma, 0.0);
  EXPECT_LT(sigma, 0.01);
}

// The first one is taken for sharp, and is not.
TEST(OrientationTracking, AVelocityDoesNotInheritWhatTheReferenceHasWrong) {
  OrientationTracking orientation((TrackerConfig()));
  constexpr double kLong = 0.03;  // [s]
  double squares = 0.0;
  for (int i = 0; i < kCount; ++i) {
    ASSERT_TRUE(orientation.track(frameOf(render(i, kLong), i, kLong))) << "frame " << i;
    const Eigen::Vector3d error = orientation.last().velocity.tail<3>() - angularVelocity(kInterval * i);
    if (i > 1) squares += error.squaredNorm();
  }
  EXPECT_LT(std::sqrt(squares / (kCount - 2)), 0.09);
}

TEST(OrientationTracking, SaysWhenNothingCanBeSeenAndGoesOnAfterwards) {
  OrientationTracking orientation((TrackerConfig()));
  EXPECT_TRUE(orientation.track(frameOf(render(0), 0)));
  EXPECT_TRUE(orientation.track(frameOf(render(1), 1)));
  const FrameConstPtr covered = test::makeFrame(cv::Mat1f(240, 376, 10.0F), std::llround(2e9 * kInterval), kExposure);
  EXPECT_FALSE(orientation.track(covered));
  const SE3 before = orientation.last().T_reference_mid;
  EXPECT_FALSE(orientation.track(frameOf(render(3), 3))) << "nothing to compare it with";
  EXPECT_TRUE(orientation.track(frameOf(render(4), 4)));
  EXPECT_TRUE(orientation.last().T_reference_mid.log().allFinite());
  EXPECT_LT(degreesBetween(before, orientation.last().T_reference_mid), 20.0);
}

TEST(OrientationTracking, BeginsAnewWhenTimeGoesBack) {
  OrientationTracking orientation((TrackerConfig()));
  orientation.track(frameOf(render(5), 5));
  orientation.track(frameOf(render(6), 6));
  EXPECT_TRUE(orientation.track(frameOf(render(2), 2)));
  EXPECT_EQ(degreesBetween(orientation.last().T_reference_mid, SE3()), 0.0);
}

}  // namespace
}  // namespace mba_vo::orientation_tracking_test
