#include "mba_vo/ros/tracking_image.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "ros/view_fixture.h"

namespace mba_vo::tracking_image_test {
namespace {

using test::viewCamera;
using test::viewFrame;
using test::viewReference;

Eigen::Vector2d seenAt(const Eigen::Vector3d& point, const ExposureTrajectory& trajectory, double t) {
  return viewCamera().project((trajectory.T_reference_mid * SE3::exp(t * trajectory.velocity)).inverse() * point);
}

bool isColored(const cv::Vec3b& pixel) { return pixel[0] != pixel[1] || pixel[1] != pixel[2]; }

bool isColoredNear(const cv::Mat3b& image, const Eigen::Vector2d& place) {
  const int x = static_cast<int>(std::lround(place.x()));
  const int y = static_cast<int>(std::lround(place.y()));
  return isColored(image(y, x));
}

TEST(TrackingImage, PathIsWhereThePointIsProjectedToFromStartToEnd) {
  const ExposureTrajectory trajectory = viewFrame()->trajectory;
  const Eigen::Vector3d point(0.2, -0.1, 2.0);
  const std::vector<Eigen::Vector2d> path = blurPath(point, trajectory, viewCamera(), 4);
  ASSERT_EQ(path.size(), 5U);
  for (int i = 0; i <= 4; ++i) {
    const double t = 0.03 * (0.25 * i - 0.5);
    EXPECT_LT((path[static_cast<std::size_t>(i)] - seenAt(point, trajectory, t)).norm(), 1e-9) << i;
  }
  EXPECT_GT((path.back() - path.front()).norm(), 10.0) << "there is something to be seen";
}

TEST(TrackingImage, UnderARollingShutterThePathIsThatOfThePointsRow) {
  const ExposureTrajectory trajectory = viewFrame()->trajectory;
  const Eigen::Vector3d point(0.2, -0.5, 2.0);  // in the upper half, which is exposed early
  const PinholeCamera rolling = viewCamera(1e-4);
  const double delay = rolling.rowDelay(seenAt(point, trajectory, 0.0).y());
  EXPECT_LT(delay, -0.004);
  const std::vector<Eigen::Vector2d> path = blurPath(point, trajectory, rolling, 1);
  ASSERT_EQ(path.size(), 2U);
  EXPECT_LT((path.front() - seenAt(point, trajectory, delay - 0.015)).norm(), 1e-9);
  EXPECT_LT((path.back() - seenAt(point, trajectory, delay + 0.015)).norm(), 1e-9);
}

TEST(TrackingImage, WhatIsBehindOrOutsideHasNoPath) {
  const ExposureTrajectory trajectory = viewFrame()->trajectory;
  EXPECT_TRUE(blurPath({0.0, 0.0, -2.0}, trajectory, viewCamera(), 4).empty());
  EXPECT_TRUE(blurPath({9.0, 0.0, 2.0}, trajectory, viewCamera(), 4).empty());
  EXPECT_TRUE(blurPath(trajectory.T_reference_mid.translation(), trajectory, viewCamera(), 4).empty());
}

TEST(TrackingImage, EveryPointIsDrawnAlongItsPathAndNowhereElse) {
  const auto tracked = viewFrame();
  const auto reference = viewReference({{80.0F, 60.0F, 1.0F}, {200.0F, 90.0F, 2.0F}, {160.0F, 140.0F, 5.0F}});
  const std::vector<DrawnPoint> points = drawnPoints(*tracked, *reference);
  ASSERT_EQ(points.size(), 3U);
  const cv::Mat3b image = drawTracking(*tracked, reference);
  ASSERT_EQ(image.size(), cv::Size(320, 240));
  int colored = 0;
  for (const DrawnPoint& point : points) {
    for (const Eigen::Vector2d& place : point.path) EXPECT_TRUE(isColoredNear(image, place)) << place.transpose();
  }
  for (const cv::Vec3b& pixel : image) colored += isColored(pixel) ? 1 : 0;
  EXPECT_LT(colored, 600) << "three short lines with a dot each";
}

TEST(TrackingImage, NearIsRedAndFarIsBlue) {
  const auto tracked = viewFrame();
  const auto reference = viewReference({{80.0F, 60.0F, 0.5F}, {200.0F, 90.0F, 2.0F}, {160.0F, 140.0F, 9.0F}});
  const cv::Mat3b image = drawTracking(*tracked, reference);
  const auto colorOf = [&](const DrawnPoint& point) {
    return image(static_cast<int>(std::lround(point.path.back().y())),
                 static_cast<int>(std::lround(point.path.back().x())));
  };
  for (const DrawnPoint& point : drawnPoints(*tracked, *reference)) {
    const cv::Vec3b color = colorOf(point);
    if (point.depth < 1.0) {
      EXPECT_GT(color[2], color[0]) << "near";
    }
    if (point.depth > 4.0) {
      EXPECT_GT(color[0], color[2]) << "far";
    }
  }
}

TEST(TrackingImage, PointsAreLeftOutWhereTheyWouldMeanNothing) {
  const auto reference = viewReference({{80.0F, 60.0F, 1.0F}, {200.0F, 90.0F, 2.0F}});
  const auto isGrey = [](const cv::Mat3b& image) {
    return std::none_of(image.begin(), image.end(), [](const cv::Vec3b& pixel) { return isColored(pixel); });
  };
  auto tracked = viewFrame();
  EXPECT_FALSE(isGrey(drawTracking(*tracked, reference)));
  EXPECT_TRUE(isGrey(drawTracking(*tracked, nullptr)));
  tracked->reference.keyframe_id = 4;
  EXPECT_TRUE(isGrey(drawTracking(*tracked, reference))) << "tracked with another keyframe";
  tracked->reference.keyframe_id = 3;
  tracked->status = TrackingStatus::kLost;
  EXPECT_TRUE(isGrey(drawTracking(*tracked, reference))) << "no pose";
  tracked->status = TrackingStatus::kTracking;
  reference->at_infinity = true;
  EXPECT_TRUE(isGrey(drawTracking(*tracked, reference))) << "no depths";
}

}  // namespace
}  // namespace mba_vo::tracking_image_test
