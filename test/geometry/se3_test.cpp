#include "mba_vo/geometry/se3.h"

#include <gtest/gtest.h>

#include <unsupported/Eigen/MatrixFunctions>

#include "mba_vo/geometry/exposure_trajectory.h"
#include "mba_vo/geometry/pinhole_camera.h"
#include "support/jacobian.h"
#include "support/random.h"

namespace mba_vo::se3_test {
namespace {

Eigen::Matrix4d matrix(const SE3& T) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = T.rotationMatrix();
  m.topRightCorner<3, 1>() = T.translation();
  return m;
}

Eigen::Matrix4d algebra(const Vector6& xi) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
  m.topLeftCorner<3, 3>() = hat(xi.tail<3>());
  m.topRightCorner<3, 1>() = xi.head<3>();
  return m;
}

TEST(SE3, GroupAxioms) {
  test::Random random(1);
  for (int i = 0; i < 200; ++i) {
    const SE3 a = random.pose(2.0, 2.0);
    const SE3 b = random.pose(2.0, 2.0);
    const SE3 c = random.pose(2.0, 2.0);
    EXPECT_LT((matrix((a * b) * c) - matrix(a * (b * c))).norm(), 1e-12);
    EXPECT_LT((matrix(a * a.inverse()) - Eigen::Matrix4d::Identity()).norm(), 1e-12);
    EXPECT_LT((matrix(a * b) - matrix(a) * matrix(b)).norm(), 1e-12);
    const Eigen::Vector3d p = random.tangent(3.0, 0.0).head<3>();
    EXPECT_LT(((a * b) * p - a * (b * p)).norm(), 1e-12);
  }
}

TEST(SE3, ExpIsTheMatrixExponential) {
  test::Random random(2);
  for (const double angle : {1e-9, 1e-5, 1e-3, 0.1, 1.5}) {
    for (int i = 0; i < 20; ++i) {
      const Vector6 xi = random.tangent(1.0, angle);
      EXPECT_LT((matrix(SE3::exp(xi)) - algebra(xi).exp()).norm(), 1e-12);
    }
  }
}

TEST(SE3, LogInvertsExp) {
  test::Random random(3);
  for (const double angle : {1e-10, 1e-6, 1e-4, 1e-2, 1.0, 1.8}) {
    for (int i = 0; i < 50; ++i) {
      const Vector6 xi = random.tangent(2.0, angle);
      EXPECT_LT((SE3::exp(xi).log() - xi).norm(), 1e-9);
    }
  }
}

TEST(SE3, AdjointMovesIncrementsAcross) {
  test::Random random(4);
  for (int i = 0; i < 50; ++i) {
    const SE3 T = random.pose(2.0, 2.0);
    const Vector6 x = random.tangent(0.5, 0.5);
    EXPECT_LT((matrix(T * SE3::exp(x)) - matrix(SE3::exp(T.adjoint() * x) * T)).norm(), 1e-12);
  }
}

TEST(SE3, JacobiansOfExp) {
  test::Random random(5);
  for (const double angle : {1e-6, 5e-3, 2e-2, 0.3, 1.5}) {
    for (int i = 0; i < 20; ++i) {
      const Vector6 xi = random.tangent(1.0, angle);
      const SE3 inverse = SE3::exp(xi).inverse();
      const auto right = test::numericJacobian(
          [&](const Eigen::VectorXd& d) { return Eigen::VectorXd((inverse * SE3::exp(xi + Vector6(d))).log()); }, 6);
      const auto left = test::numericJacobian(
          [&](const Eigen::VectorXd& d) { return Eigen::VectorXd((SE3::exp(xi + Vector6(d)) * inverse).log()); }, 6);
      EXPECT_LT((rightJacobian(xi) - right).norm(), 1e-7);
      EXPECT_LT((leftJacobian(xi) - left).norm(), 1e-7);
    }
  }
}

TEST(ExposureTrajectory, StartAndEndDetermineIt) {
  test::Random random(6);
  for (int i = 0; i < 50; ++i) {
    const SE3 start = random.pose(1.0, 1.0);
    const SE3 end = start * random.pose(0.1, 0.1);
    const ExposureTrajectory t = ExposureTrajectory::fromStartAndEnd(start, end, 0.02);
    EXPECT_LT((matrix(t.start()) - matrix(start)).norm(), 1e-12);
    EXPECT_LT((matrix(t.end()) - matrix(end)).norm(), 1e-12);
    EXPECT_LT((t.xi() - (start.inverse() * end).log()).norm(), 1e-12);
  }
}

TEST(ExposureTrajectory, TimeReversalSwapsStartAndEnd) {
  test::Random random(7);
  ExposureTrajectory t{random.pose(1.0, 1.0), random.tangent(1.0, 2.0), 0.02};
  const SE3 start = t.start();
  t.velocity = -t.velocity;
  EXPECT_LT((matrix(t.end()) - matrix(start)).norm(), 1e-12);
}

TEST(PinholeCamera, HalvingKeepsRays) {
  const PinholeCamera camera{752, 480, 430.0, 425.0, 375.5, 239.5};
  const PinholeCamera half = camera.halved();
  // The centre of the 2x2 block (2x, 2y)..(2x+1, 2y+1) is the centre of coarse pixel (x, y).
  const Eigen::Vector3d fine_ray = camera.unproject({2.0 * 100 + 0.5, 2.0 * 50 + 0.5});
  EXPECT_LT((half.unproject({100.0, 50.0}) - fine_ray).norm(), 1e-12);
}

TEST(PinholeCamera, ProjectionJacobian) {
  const PinholeCamera camera{752, 480, 430.0, 425.0, 375.5, 239.5};
  test::Random random(8);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0.5, 3.0));
    const auto numeric = test::numericJacobian(
        [&](const Eigen::VectorXd& d) { return Eigen::VectorXd(camera.project(p + Eigen::Vector3d(d))); }, 3);
    EXPECT_LT((camera.projectionJacobian(p) - numeric).norm(), 1e-5);
    EXPECT_LT((camera.unproject(camera.project(p)) * p.z() - p).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace mba_vo::se3_test
