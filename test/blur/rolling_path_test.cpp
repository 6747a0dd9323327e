#include <gtest/gtest.h>

#include "mba_vo/blur/fixed_motion_path.h"
#include "mba_vo/blur/patch_path.h"
#include "support/jacobian.h"
#include "support/random.h"

namespace mba_vo::rolling_path_test {
namespace {

PinholeCamera rollingCamera(const PinholeCamera& camera, double row_time) {
  PinholeCamera rolling = camera;
  rolling.row_time = row_time;
  return rolling;
}

const PinholeCamera kReferenceCamera = rollingCamera({752, 480, 430.0, 425.0, 375.5, 239.5}, 6e-5);
const PinholeCamera kCamera = rollingCamera({640, 480, 520.0, 510.0, 320.5, 238.0}, 5e-5);

/// Fast shaking: 30 px between the first row and the last.
struct Case {
  ExposureTrajectory trajectory;
  BodyMotion reference_motion;
  Eigen::Vector2d pixel;
  Eigen::Vector2d reference_pixel;
  double inverse_depth;
};

Case randomCase(test::Random& random, double exposure) {
  Case c;
  c.trajectory = {random.pose(0.2, 0.2), random.tangent(0.7, 1.5), exposure, random.tangent(5.0, 10.0)};
  c.reference_motion = {random.tangent(0.7, 1.5), random.tangent(5.0, 10.0)};
  c.pixel = {random.uniform(50, 600), random.uniform(50, 430)};
  c.reference_pixel = {random.uniform(50, 700), random.uniform(50, 430)};
  c.inverse_depth = random.uniform(0.2, 1.5);
  return c;
}

/// Where the pixel looks at u in the exposure of its row, by poses alone: that of the row, seen from where the
/// reference was when it read the row of the point.
Eigen::Vector2d lookUp(const Case& c, const Vector6& delta, const Vector6& epsilon, double depth_change, double u) {
  const Vector6 velocity = c.trajectory.velocity + epsilon / c.trajectory.exposure;
  const double t = (c.pixel.y() - 239.5) * kCamera.row_time + u * c.trajectory.exposure;
  const double t_reference = (c.reference_pixel.y() - 239.5) * kReferenceCamera.row_time;
  const SE3 T = SE3::exp(c.reference_motion.until(t_reference)).inverse() * c.trajectory.T_reference_mid *
                SE3::exp(delta) * SE3::exp(t * velocity + 0.5 * t * t * c.trajectory.acceleration);
  const PixelTransfer transfer = transferPixel(kReferenceCamera, kCamera, T, c.pixel, c.inverse_depth + depth_change);
  EXPECT_TRUE(transfer.valid);
  return transfer.pixel;
}

TEST(ShortMotion, IsTheExponential) {
  test::Random random(1);
  for (int i = 0; i < 50; ++i) {
    const Vector6 velocity = random.tangent(1.0, 2.0);
    const SE3 expected = SE3::exp(0.015 * velocity);
    const RigidMotion motion = shortMotion(velocity, 0.015);
    EXPECT_LT((motion.R - expected.rotationMatrix()).norm(), 1e-8);
    EXPECT_LT((motion.p - expected.translation()).norm(), 1e-8);
  }
}

TEST(MovingPose, FollowsTheExponential) {
  test::Random random(3);
  for (int i = 0; i < 50; ++i) {
    const SE3 T = random.pose(1.0, 3.0);
    const BodyMotion motion{random.tangent(1.0, 2.0), random.tangent(5.0, 10.0)};
    const double t = random.uniform(-0.015, 0.015);
    const SE3 expected = T * SE3::exp(motion.until(t));
    const RigidMotion pose = MovingPose(RigidMotion(T), motion).at(t);
    EXPECT_LT((pose.R - expected.rotationMatrix()).norm(), 2e-6);
    EXPECT_LT((pose.p - expected.translation()).norm(), 2e-6);
  }
}

TEST(ProjectRolling, TheRowIsReadWhenThePointIsThere) {
  test::Random random(2);
  for (int i = 0; i < 100; ++i) {
    const BodyMotion motion{random.tangent(0.7, 1.5), random.tangent(5.0, 10.0)};
    const Eigen::Vector3d point =
        random.uniform(1.0, 4.0) * kCamera.unproject({random.uniform(50, 600), random.uniform(50, 430)});
    const auto seen = projectRolling(kCamera, motion, point);
    ASSERT_TRUE(seen.has_value());
    const Eigen::Vector3d then = SE3::exp(motion.until((seen->pixel.y() - 239.5) * 5e-5)).inverse() * point;
    EXPECT_LT((kCamera.project(then) - seen->pixel).norm(), 1e-3);
    EXPECT_NEAR(then.z(), seen->depth, 1e-5);
  }
  EXPECT_FALSE(projectRolling(kCamera, {}, {0.0, 0.0, -1.0}).has_value());
}

TEST(RollingPath, FollowsThePoseOfTheRow) {
  test::Random random(3);
  for (const double exposure : {0.02, 1e-4}) {
    for (int i = 0; i < 100; ++i) {
      const Case c = randomCase(random, exposure);
      PatchPath path;
      ASSERT_TRUE(PatchPathMaker(kReferenceCamera, kCamera, c.trajectory, c.reference_motion)
                      .make(c.pixel, c.inverse_depth, path, c.reference_pixel.y()));
      for (const float u : {-0.5F, 0.0F, 0.25F, 0.5F}) {
        const Eigen::Vector2f place = path.c0 + u * (path.c1 + u * path.c2);
        const Eigen::Vector2d exact = lookUp(c, Vector6::Zero(), Vector6::Zero(), 0.0, static_cast<double>(u));
        EXPECT_LT((place.cast<double>() - exact).norm(), 0.05);
      }
    }
  }
}

TEST(RollingPath, Jacobians) {
  test::Random random(4);
  for (const double exposure : {0.02, 1e-3}) {
    for (int i = 0; i < 100; ++i) {
      const Case c = randomCase(random, exposure);
      PatchPath path;
      ASSERT_TRUE(PatchPathMaker(kReferenceCamera, kCamera, c.trajectory, c.reference_motion)
                      .make(c.pixel, c.inverse_depth, path, c.reference_pixel.y()));
      const Vector6 zero = Vector6::Zero();
      for (const double u : {-0.5, 0.0, 0.3, 0.5}) {
        const auto J_delta = test::numericJacobian(
            [&](const Eigen::VectorXd& d) { return Eigen::VectorXd(lookUp(c, Vector6(d), zero, 0.0, u)); }, 6);
        const auto J_epsilon = test::numericJacobian(
            [&](const Eigen::VectorXd& d) { return Eigen::VectorXd(lookUp(c, zero, exposure * Vector6(d), 0.0, u)); },
            6);
        const auto J_depth = test::numericJacobian(
            [&](const Eigen::VectorXd& d) { return Eigen::VectorXd(lookUp(c, zero, zero, d(0), u)); }, 1);
        const Matrix26 delta = path.J_pose[0] + u * path.J_pose[1];
        const Matrix26 epsilon = exposure * (path.J_xi_row + u * (path.J_xi[0] + u * path.J_xi[1]));
        const Eigen::Vector2d depth = path.J_inverse_depth[0] + u * path.J_inverse_depth[1];
        // Exact up to the curvature of the path within the exposure.
        EXPECT_LT((delta - J_delta).norm(), 0.01 * J_delta.norm());
        EXPECT_LT((epsilon - J_epsilon).norm(), 0.01 * J_epsilon.norm() + 0.01 * exposure * J_delta.norm());
        EXPECT_LT((depth - J_depth).norm(), 0.01 * J_depth.norm() + 0.5);
      }
    }
  }
}

TEST(RollingPath, WithFixedMotionIsTheSame) {
  test::Random random(5);
  for (int i = 0; i < 100; ++i) {
    // By the acceleration, other rows see another velocity within their exposures: neglected where the motion is fixed.
    const bool accelerated = i % 2 == 0;
    Case c = randomCase(random, accelerated ? 1e-9 : 0.02);
    if (!accelerated) c.trajectory.acceleration.setZero();
    const RowMotion rows{c.trajectory.motion(), c.reference_motion};
    PatchPath expected, path;
    ASSERT_TRUE(PatchPathMaker(kReferenceCamera, kCamera, c.trajectory, c.reference_motion)
                    .make(c.pixel, c.inverse_depth, expected, c.reference_pixel.y()));
    ASSERT_TRUE(FixedMotionPathMaker(kReferenceCamera, kCamera, c.trajectory, rows)
                    .make(c.pixel, c.inverse_depth, path, c.reference_pixel.y()));
    EXPECT_LT((path.c0 - expected.c0).norm(), 1e-3F);
    EXPECT_LT((path.c1 - expected.c1).norm(), 1e-3F);
    for (std::size_t part = 0; part < 2; ++part) {
      EXPECT_LT((path.J_pose[part] - expected.J_pose[part]).norm(), 1e-6 * (1.0 + expected.J_pose[part].norm()));
    }
  }
}

TEST(RollingPath, OfACameraAtRestIsThatOfAGlobalShutter) {
  PinholeCamera global = kCamera;
  global.row_time = 0.0;
  const SE3 T = test::Random(6).pose(0.2, 0.2);
  PatchPath expected, path;
  ASSERT_TRUE(FixedMotionPathMaker(global, global, {T, Vector6::Zero(), 0.0}).make({400.0, 100.0}, 0.5, expected));
  ASSERT_TRUE(FixedMotionPathMaker(kCamera, kCamera, {T, Vector6::Zero(), 0.0}).make({400.0, 100.0}, 0.5, path, 90.0));
  EXPECT_LT((path.c0 - expected.c0).norm(), 1e-4F);
}

TEST(RollingPath, RowsOfACoarserLevelHaveTheSameTimes) {
  const PinholeCamera half = kCamera.halved();
  EXPECT_NEAR(half.rowDelay(100.0), kCamera.rowDelay(200.5), 1e-12);  // the middle of rows 200 and 201
}

}  // namespace
}  // namespace mba_vo::rolling_path_test
