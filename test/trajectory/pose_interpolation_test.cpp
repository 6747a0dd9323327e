#include "mba_vo/trajectory/pose_interpolation.h"

#include <gtest/gtest.h>

#include "support/random.h"

namespace mba_vo::pose_interpolation_test {
namespace {

constexpr std::int64_t kInterval = 74'000'000;  // [ns]

double seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

TEST(InterpolatePose, IsExactForConstantVelocityAndAtTheEnds) {
  test::Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const SE3 start = random.pose(1.0, 1.0);
    const Vector6 v = random.tangent(1.0, 3.0);
    const auto at = [&](std::int64_t ns) { return StampedPose{ns, start * SE3::exp(seconds(ns) * v), v}; };
    for (const std::int64_t ns : {0L, 20'000'000L, 37'000'000L, kInterval}) {
      const StampedPose between = interpolatePose(at(0), at(kInterval), ns);
      EXPECT_LT((between.T_map_camera.inverse() * at(ns).T_map_camera).log().norm(), 1e-12);
      EXPECT_LT((between.velocity - v).norm(), 1e-12);
    }
  }
}

// A body that turns by 5 degrees an image and changes that by half: integrated in small steps.
TEST(InterpolatePose, FollowsAConstantAcceleration) {
  const Vector6 v = (Vector6() << 0.4, -0.2, 0.6, 2.3, 0.5, -0.4).finished();
  const Vector6 a = (Vector6() << 3.0, 1.0, -2.0, 16.0, -10.0, 5.0).finished();
  constexpr std::int64_t kStep = 10'000;  // [ns]
  StampedPose before{0, SE3(), v};
  StampedPose after = before;
  SE3 middle;
  for (std::int64_t ns = 0; ns < kInterval; ns += kStep) {
    if (ns == kInterval / 2) middle = after.T_map_camera;
    after.T_map_camera = after.T_map_camera * SE3::exp(seconds(kStep) * (v + seconds(ns + kStep / 2) * a));
  }
  after.mid_exposure_ns = kInterval;
  after.velocity = v + seconds(kInterval) * a;
  const Vector6 error = (middle.inverse() * interpolatePose(before, after, kInterval / 2).T_map_camera).log();
  EXPECT_LT(error.head<3>().norm(), 3e-5);  // constant velocity from the first on: 2.6e-3 m
  EXPECT_LT(error.tail<3>().norm(), 3e-4);  // 0.013 rad
  const Vector6 velocity = interpolatePose(before, after, kInterval / 2).velocity;
  EXPECT_LT((velocity - (v + 0.5 * seconds(kInterval) * a)).norm(), 1e-9);
  // With an error of the velocities of 0.1 m/s on both sides, an eighth of the interval of it.
  before.velocity(0) += 0.1;
  after.velocity(0) -= 0.1;
  const Vector6 disturbed = (middle.inverse() * interpolatePose(before, after, kInterval / 2).T_map_camera).log();
  EXPECT_NEAR(disturbed(0) - error(0), 0.25 * seconds(kInterval) * 0.1, 2e-4);
}

TEST(VelocityByPoses, IsThatOfAConstantAcceleration) {
  test::Random random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const SE3 start = random.pose(1.0, 1.0);
    const Vector6 v = random.tangent(1.0, 3.0);
    Vector6 a = Vector6::Zero();
    a.head<3>() = random.tangent(5.0, 0.0).head<3>();
    // The body does not turn where it accelerates: its coordinates are those of the tangent space then.
    const Vector6 at_rest = (Vector6() << v.head<3>(), Eigen::Vector3d::Zero()).finished();
    const auto accelerating = [&](std::int64_t ns) {
      const double t = seconds(ns);
      return StampedPose{ns, start * SE3::exp(t * at_rest + 0.5 * t * t * a), Vector6::Zero()};
    };
    const Vector6 found = velocityByPoses(accelerating(-kInterval), accelerating(0), accelerating(kInterval / 2));
    EXPECT_LT((found - at_rest).norm(), 1e-9);
    const auto turning = [&](std::int64_t ns) {
      return StampedPose{ns, start * SE3::exp(seconds(ns) * v), Vector6::Zero()};
    };
    EXPECT_LT((velocityByPoses(turning(-kInterval), turning(0), turning(kInterval / 2)) - v).norm(), 1e-9);
  }
}

TEST(FusedPose, LiesNearerToTheBetterKnownPose) {
  test::Random random(2);
  const SE3 T = random.pose(1.0, 1.0);
  const Vector6 difference = random.tangent(0.01, 0.01);
  const SE3 T_other = T * SE3::exp(difference);
  const Vector6 sigma = (Vector6() << 1, 2, 3, 0.4, 0.5, 0.6).finished();
  const Matrix6 same = sigma.cwiseAbs2().asDiagonal();
  const auto movedBy = [&](double factor) {
    return Vector6((T.inverse() * fusedPose(T, factor * same, T_other, sigma)).log());
  };
  EXPECT_LT((movedBy(1.0) - 0.5 * difference).norm(), 1e-12);
  EXPECT_LT((movedBy(3.0) - 0.75 * difference).norm(), 1e-12);
  EXPECT_LT(movedBy(1e-6).norm(), 1e-6);
  // What is measured badly in one direction only moves in that one.
  Matrix6 one = 1e-12 * Matrix6::Identity();
  one(1, 1) = 1e6;
  const Vector6 moved = (T.inverse() * fusedPose(T, one, T_other, sigma)).log();
  EXPECT_LT((moved - difference(1) * Vector6::Unit(1)).norm(), 1e-6);
}

}  // namespace
}  // namespace mba_vo::pose_interpolation_test
