#include "mba_vo/odometry/dead_reckoning.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "support/rendered_room.h"

namespace mba_vo::dead_reckoning_test {
namespace {

constexpr double kExposure = 0.01;  // [s]
constexpr double kInterval = 0.04;  // [s]
constexpr double kSpeed = 0.5;      // to the right of where the camera looks at first [m/s]
constexpr double kTurn = 1.8;       // to the left [rad/s]
constexpr double kDepth = 2.0;      // [m]
constexpr double kMemory = 0.2;     // [s]

SE3 truth(double t) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(-kTurn * t, Eigen::Vector3d::UnitY())),
          Eigen::Vector3d(kSpeed * t, 0.0, 0.0)};
}

SE3 truthAt(int image) { return truth(kInterval * image); }
std::int64_t timeOf(int image) { return std::llround(1e9 * kInterval * image); }

FrameConstPtr frameAt(int image) {
  const SE3 T_world_start = test::roomSimulator().pose(1.0);
  const auto rendered =
      test::roomSimulator().renderExposure([&](double at) { return T_world_start * truth(at); }, kInterval * image,
                                           kExposure, static_cast<std::uint64_t>(image));
  return test::makeFrame(test::toFloat(rendered.blurred), timeOf(image), kExposure, static_cast<std::uint64_t>(image));
}

/// Aligned to a map, with a velocity known as well as that [m/s].
TrackedFrame trackedAt(int image, double velocity_sigma) {
  TrackedFrame tracked;
  tracked.frame = frameAt(image);
  tracked.status = TrackingStatus::kTracking;
  tracked.trajectory.exposure = kExposure;
  tracked.trajectory.velocity << truthAt(image).rotationMatrix().transpose() * Eigen::Vector3d(kSpeed, 0.0, 0.0), 0.0,
      -kTurn, 0.0;
  tracked.xi_prior_limited = false;
  const double variance = velocity_sigma * velocity_sigma * kExposure * kExposure / 3.0;
  tracked.covariance.diagonal().segment<3>(6).setConstant(variance);
  tracked.expected_error = 0.1 * std::sqrt(0.5);  // so that the covariance counts as it is
  return tracked;
}

double degreesBetween(const SE3& a, const SE3& b) { return a.rotation().angularDistance(b.rotation()) * 180.0 / M_PI; }

/// Degrees: a way that is not known looks like a turn, here by 7 degrees a second.
double tolerance(int image) {
  const double unknown = std::max(0.0, kInterval * (image - 2) - kLongestPrediction);  // [s]
  return 0.9 + unknown * kSpeed / kDepth * 180.0 / M_PI;
}

TEST(DeadReckoning, TurnsAsTheImagesDoAndGoesOnForAMoment) {
  DeadReckoning reckoning(TrackerConfig(), kMemory);
  reckoning.beginAt(trackedAt(2, 0.0), truthAt(2), kDepth);
  for (int i = 3; i < 10; ++i) {
    ASSERT_TRUE(reckoning.track(frameAt(i))) << "frame " << i;
    EXPECT_LT(degreesBetween(reckoning.T_odom_camera(), truthAt(i)), tolerance(i)) << "frame " << i;
    const double predicted = std::min(kLongestPrediction, kInterval * (i - 2));
    const double x = truthAt(2).translation().x() + predicted * kSpeed;
    EXPECT_LT((reckoning.T_odom_camera().translation() - Eigen::Vector3d(x, 0.0, 0.0)).norm(), 1e-9) << "frame " << i;
    if (i < 6) {
      EXPECT_NEAR(reckoning.velocity()(4), -kTurn, 0.5) << "frame " << i;
    }
  }
  EXPECT_GT(degreesBetween(truthAt(2), truthAt(9)), 25.0) << "it has to change its reference";
}

TEST(DeadReckoning, TellsWhereTheCameraWasAndHowItTurned) {
  DeadReckoning reckoning(TrackerConfig(), kMemory);
  reckoning.beginAt(trackedAt(2, 0.0), truthAt(2), kDepth);
  for (int i = 3; i < 9; ++i) reckoning.track(frameAt(i));
  EXPECT_LT(degreesBetween(reckoning.T_odom_cameraAt(timeOf(5)), truthAt(5)), tolerance(5));
  EXPECT_LT(degreesBetween(reckoning.T_odom_cameraAt(timeOf(8) + 1), truthAt(8)), tolerance(8)) << "the last one known";
  EXPECT_LT(degreesBetween(reckoning.T_odom_cameraAt(timeOf(0)), truthAt(3)), tolerance(3)) << "the first remembered";
  const auto turn = reckoning.turnBetween(timeOf(4), timeOf(6));
  ASSERT_TRUE(turn);
  EXPECT_LT(degreesBetween({turn->R_from_to, {}}, truthAt(4).inverse() * truthAt(6)), tolerance(6));
  EXPECT_NEAR(turn->angular_velocity.y(), -kTurn, 0.5);
  EXPECT_FALSE(reckoning.turnBetween(timeOf(2), timeOf(8))) << "longer ago than it remembers";
  EXPECT_FALSE(reckoning.turnBetween(timeOf(8), timeOf(8) + 1));
}

TEST(DeadReckoning, WhatIsNotMeasuredIsNotTold) {
  DeadReckoning reckoning(TrackerConfig(), kMemory);
  reckoning.beginAt(trackedAt(2, 0.0), truthAt(2), kDepth);
  EXPECT_TRUE(reckoning.track(frameAt(3)));
  EXPECT_FALSE(reckoning.track(test::makeFrame(cv::Mat1f(240, 376, 90.0F), timeOf(4), kExposure)));
  EXPECT_TRUE(reckoning.turnBetween(timeOf(2), timeOf(3)));
  EXPECT_FALSE(reckoning.turnBetween(timeOf(2), timeOf(4)));
}

/// The acceleration bends the way; an uncertain velocity counts for less, and no more than itself is in doubt.
TEST(DeadReckoning, ThePlaceIsKnownForAMoment) {
  const double acceleration = TrackerConfig().motion_prior.linear_acceleration;
  for (const double sigma : {0.0, 0.2, 5.0}) {
    DeadReckoning reckoning(TrackerConfig(), kMemory);
    EXPECT_EQ(reckoning.positionSigma(), std::numeric_limits<double>::infinity());
    reckoning.beginAt(trackedAt(2, sigma), truthAt(2), kDepth);
    reckoning.track(frameAt(4));
    const double seconds = 2.0 * kInterval;
    const double bend = 0.5 * seconds * seconds * acceleration;
    EXPECT_NEAR(reckoning.positionSigma(), std::hypot(bend, seconds * std::min(sigma, kSpeed) / kDepth), 1e-6) << sigma;
    const double known = std::max(0.0, 1.0 - sigma * sigma / (kSpeed * kSpeed));
    EXPECT_NEAR(reckoning.T_odom_camera().translation().x() - truthAt(2).translation().x(), seconds * known * kSpeed,
                1e-6)
        << sigma;
    reckoning.track(frameAt(9));
    const double unmeasured = 7.0 * kInterval - kLongestPrediction;
    const double way = (0.5 * kLongestPrediction + unmeasured) * kLongestPrediction * acceleration;
    EXPECT_NEAR(reckoning.positionSigma(), std::hypot(way, 7.0 * kInterval * std::min(sigma, kSpeed) / kDepth), 1e-6);
  }
}

TEST(DeadReckoning, FromTheVeryFirstImageItTurnsOnTheSpot) {
  DeadReckoning reckoning(TrackerConfig(), kMemory);
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(reckoning.track(frameAt(i)));
  EXPECT_LT(degreesBetween(reckoning.T_odom_camera(), truthAt(3)), tolerance(2) + 1.8) << "its way of 6 cm is in it";
  EXPECT_EQ(reckoning.T_odom_camera().translation().norm(), 0.0);
}

}  // namespace
}  // namespace mba_vo::dead_reckoning_test
