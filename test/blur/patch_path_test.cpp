#include "mba_vo/blur/patch_path.h"

#include <gtest/gtest.h>

#include "support/jacobian.h"
#include "support/random.h"

namespace mba_vo::patch_path_test {
namespace {

const PinholeCamera kCamera{752, 480, 430.0, 425.0, 375.5, 239.5};

/// Independent statement of the transfer: the ray of the blurred pixel is intersected with the plane by a linear solve.
Eigen::Vector2d transferBySolving(const SE3& T, const Eigen::Vector2d& pixel, double inverse_depth) {
  const Eigen::Vector3d ray = kCamera.unproject(pixel);
  // T (s ray) must have z = d: unknowns (P, s) of P - s R ray = p, P_z = d.
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  A.topLeftCorner<3, 3>().setIdentity();
  A.topRightCorner<3, 1>() = -(T.rotationMatrix() * ray);
  A(3, 2) = 1.0;
  Eigen::Vector4d b;
  b << T.translation(), 1.0 / inverse_depth;
  const Eigen::Vector4d x = A.fullPivLu().solve(b);
  return kCamera.project(x.head<3>());
}

struct Case {
  ExposureTrajectory trajectory;
  Eigen::Vector2d pixel;
  double inverse_depth;
};

Case randomCase(test::Random& random, double blur_rotation) {
  Case c;
  c.trajectory = {random.pose(0.2, 0.2), random.tangent(0.5 * blur_rotation, blur_rotation) / 0.02, 0.02};
  c.trajectory.acceleration = random.tangent(0.1 * blur_rotation, 0.2 * blur_rotation) / (0.02 * 0.02);
  c.pixel = {random.uniform(50, 700), random.uniform(50, 430)};
  c.inverse_depth = random.uniform(0.2, 1.5);
  return c;
}

TEST(TransferPixel, AgreesWithSolvingForTheIntersection) {
  test::Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Case c = randomCase(random, 0.0);
    const PixelTransfer t = transferPixel(kCamera, kCamera, c.trajectory.T_reference_mid, c.pixel, c.inverse_depth);
    ASSERT_TRUE(t.valid);
    EXPECT_LT((t.pixel - transferBySolving(c.trajectory.T_reference_mid, c.pixel, c.inverse_depth)).norm(), 1e-8);
  }
}

TEST(TransferPixel, Jacobians) {
  test::Random random(2);
  for (int i = 0; i < 200; ++i) {
    const Case c = randomCase(random, 0.0);
    const SE3& T = c.trajectory.T_reference_mid;
    const PixelTransfer t = transferPixel(kCamera, kCamera, T, c.pixel, c.inverse_depth);
    const auto pose = test::numericJacobian(
        [&](const Eigen::VectorXd& d) {
          return Eigen::VectorXd(transferBySolving(T * SE3::exp(Vector6(d)), c.pixel, c.inverse_depth));
        },
        6);
    const auto depth = test::numericJacobian(
        [&](const Eigen::VectorXd& d) {
          return Eigen::VectorXd(transferBySolving(T, c.pixel, c.inverse_depth + d(0)));
        },
        1);
    EXPECT_LT((t.J_pose - pose).norm(), 1e-5 * (1.0 + pose.norm()));
    EXPECT_LT((t.J_inverse_depth - depth).norm(), 1e-5 * (1.0 + depth.norm()));
  }
}

TEST(TransferPixel, PlaneBehindTheCameraIsInvalid) {
  const SE3 T(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.0, 0.0, 3.0));
  EXPECT_FALSE(transferPixel(kCamera, kCamera, T, {300.0, 200.0}, 0.5).valid);
  const SE3 turned = SE3::exp((Vector6() << 0, 0, 0, 0, 3.0, 0).finished());
  EXPECT_FALSE(transferPixel(kCamera, kCamera, turned, {375.0, 240.0}, 0.5).valid);
}

TEST(PatchPath, FollowsTheExactTransferWithinTheExposure) {
  test::Random random(3);
  for (int i = 0; i < 200; ++i) {
    const Case c = randomCase(random, 0.04);  // up to about 40 px
    PatchPath path;
    ASSERT_TRUE(makePatchPath(kCamera, kCamera, c.trajectory, c.pixel, c.inverse_depth, path));
    for (double u = -0.5; u <= 0.5; u += 0.125) {
      const SE3 T = c.trajectory.at(u * c.trajectory.exposure);
      for (const Eigen::Vector2d& offset : {Eigen::Vector2d(0, 0), Eigen::Vector2d(4, -4), Eigen::Vector2d(-4, 3)}) {
        const Eigen::Vector2d exact = transferBySolving(T, c.pixel + offset, c.inverse_depth);
        const auto uf = static_cast<float>(u);
        const Eigen::Vector2f approximate =
            path.c0 + uf * (path.c1 + uf * path.c2) + (path.A0 + uf * path.A1) * offset.cast<float>();
        EXPECT_LT((approximate.cast<double>() - exact).norm(), 0.1);
      }
    }
  }
}

TEST(PatchPath, JacobiansOfTheMovingPose) {
  test::Random random(4);
  for (int i = 0; i < 100; ++i) {
    const Case c = randomCase(random, 0.04);
    PatchPath path;
    ASSERT_TRUE(makePatchPath(kCamera, kCamera, c.trajectory, c.pixel, c.inverse_depth, path));
    const auto position = [&](const Vector6& delta, const Vector6& epsilon, double depth_change, double u) {
      const double t = u * c.trajectory.exposure;
      const Vector6 motion = u * (c.trajectory.xi() + epsilon) + 0.5 * t * t * c.trajectory.acceleration;
      const SE3 T = c.trajectory.T_reference_mid * SE3::exp(delta) * SE3::exp(motion);
      return Eigen::VectorXd(transferBySolving(T, c.pixel, c.inverse_depth + depth_change));
    };
    const Vector6 zero = Vector6::Zero();
    for (const double u : {-0.5, 0.0, 0.3, 0.5}) {
      const auto J_delta =
          test::numericJacobian([&](const Eigen::VectorXd& d) { return position(Vector6(d), zero, 0.0, u); }, 6);
      const auto J_epsilon =
          test::numericJacobian([&](const Eigen::VectorXd& d) { return position(zero, Vector6(d), 0.0, u); }, 6);
      const auto J_depth =
          test::numericJacobian([&](const Eigen::VectorXd& d) { return position(zero, zero, d(0), u); }, 1);
      const Matrix26 delta = path.J_pose[0] + u * path.J_pose[1];
      const Matrix26 epsilon = u * (path.J_xi[0] + u * path.J_xi[1]);
      const Eigen::Vector2d depth = path.J_inverse_depth[0] + u * path.J_inverse_depth[1];
      // Exact at mid-exposure and at both ends up to the curvature of the path in between.
      EXPECT_LT((delta - J_delta).norm(), 0.02 * J_delta.norm());
      EXPECT_LT((epsilon - J_epsilon).norm(), 0.02 * (J_delta.norm()));
      EXPECT_LT((depth - J_depth).norm(), 0.02 * J_depth.norm() + 0.5);
    }
  }
}

TEST(SampleCount, OneWhenSharpAndBounded) {
  EXPECT_EQ(sampleCount(0.0F, 1.25F, 64), 1);
  EXPECT_EQ(sampleCount(1.2F, 1.25F, 64), 1);
  EXPECT_EQ(sampleCount(10.0F, 1.25F, 64), 8);
  EXPECT_EQ(sampleCount(40.0F, 1.25F, 64), 16);  // four times as long: twice as many
  EXPECT_EQ(sampleCount(1000.0F, 1.25F, 64), 64);
}

}  // namespace
}  // namespace mba_vo::patch_path_test
