#include "mba_vo/depth_search/epipolar_line.h"

#include <cmath>

#include <gtest/gtest.h>

namespace mba_vo::epipolar_line_test {
namespace {

const PinholeCamera kHost{640, 480, 400.0, 410.0, 320.0, 235.0};
const PinholeCamera kFrame{752, 480, 430.0, 425.0, 375.5, 239.5};

SE3 pose(double x, double y, double z) {
  Vector6 xi;
  xi << x, y, z, 0.04, -0.03, 0.1;
  return SE3::exp(xi);
}

class EpipolarLines : public ::testing::TestWithParam<SE3> {
 protected:
  Eigen::Vector2d project(const Eigen::Vector2d& host_pixel, double inverse_depth) const {
    return kFrame.project(GetParam() * (kHost.unproject(host_pixel) / inverse_depth));
  }
  const HostToFrame transform_{kHost, kFrame, GetParam()};
  const Eigen::Vector2d host_pixel_{200.0, 150.0};
  const EpipolarLine line_{transform_, host_pixel_};
};

TEST_P(EpipolarLines, PassesThroughTheProjections) {
  ASSERT_TRUE(line_.isValid());
  for (const double inverse_depth : {1e-6, 0.1, 0.5, 2.0}) {
    const double s = line_.distanceOf(inverse_depth);
    EXPECT_LT((line_.pixelAt(s) - project(host_pixel_, inverse_depth)).norm(), 1e-6) << inverse_depth;
    EXPECT_NEAR(line_.inverseDepthAt(s), inverse_depth, 1e-9);
  }
  EXPECT_EQ(line_.distanceOf(0.0), 0.0);
  EXPECT_GT(line_.distanceOf(0.5), line_.distanceOf(0.1));
}

TEST_P(EpipolarLines, WarpIsTheDerivativeOfTheProjection) {
  const double inverse_depth = 0.6;
  const Eigen::Matrix2d warp = line_.warpAt(inverse_depth);
  const double step = 1e-4;
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector2d offset = step * Eigen::Vector2d::Unit(i);
    const Eigen::Vector2d numeric =
        (project(host_pixel_ + offset, inverse_depth) - project(host_pixel_ - offset, inverse_depth)) / (2.0 * step);
    EXPECT_LT((warp.col(i) - numeric).norm(), 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(Poses, EpipolarLines,
                         ::testing::Values(pose(0.1, 0.02, 0.0), pose(-0.05, 0.1, 0.2), pose(0.05, 0.1, -0.3)));

TEST(EpipolarLine, DepthsBehindTheCameraHaveNoImage) {
  const EpipolarLine forward(HostToFrame(kHost, kFrame, SE3(Eigen::Quaterniond::Identity(), {0.1, 0.0, -0.5})),
                             {300.0, 200.0});
  EXPECT_TRUE(std::isfinite(forward.distanceOf(1.9)));
  EXPECT_TRUE(std::isinf(forward.distanceOf(2.1)));  // nearer than 0.5 m
  const EpipolarLine backward(HostToFrame(kHost, kFrame, SE3(Eigen::Quaterniond::Identity(), {0.1, 0.0, 0.5})),
                              {300.0, 200.0});
  const double epipole = (backward.pixelAt(0.0) - kFrame.project(Eigen::Vector3d(0.1, 0.0, 0.5))).norm();
  EXPECT_TRUE(std::isfinite(backward.inverseDepthAt(epipole - 1e-3)));
  EXPECT_TRUE(std::isinf(backward.inverseDepthAt(epipole + 1e-3)));
}

TEST(EpipolarLine, NeedsTranslationAndARayInFront) {
  EXPECT_FALSE(EpipolarLine(HostToFrame(kHost, kFrame, SE3()), {300.0, 200.0}).isValid());
  const SE3 turned(Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY())), {0.1, 0.0, 0.0});
  EXPECT_FALSE(EpipolarLine(HostToFrame(kHost, kFrame, turned), {300.0, 200.0}).isValid());
}

}  // namespace
}  // namespace mba_vo::epipolar_line_test
