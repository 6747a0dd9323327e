#include "mba_vo/depth_search/measured_depth.h"

#include <cmath>

#include <gtest/gtest.h>

namespace mba_vo::measured_depth_test {
namespace {

const float kNone = std::nanf("");

TEST(MeasuredDepth, VarianceGrowsWithDepthAndSlope) {
  DepthSensorConfig config;
  config.inverse_depth_sigma = 0.004;
  config.relative_sigma = 0.03;
  config.registration_sigma = 1.5;
  const cv::Mat1f flat(20, 30, 2.0F);
  const MeasuredDepth on_wall = measureDepth(flat, {10, 8}, config);
  EXPECT_DOUBLE_EQ(on_wall.inverse_depth, 0.5);
  EXPECT_NEAR(on_wall.variance, 0.004 * 0.004 + 0.015 * 0.015, 1e-12);

  cv::Mat1f slanted(20, 30);  // inverse depth 0.5 + 0.002 x - 0.001 y
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 30; ++x) slanted(y, x) = static_cast<float>(1.0 / (0.5 + 0.002 * x - 0.001 * y));
  }
  const MeasuredDepth on_slope = measureDepth(slanted, {10, 8}, config);
  EXPECT_NEAR(on_slope.inverse_depth, 0.512, 1e-6);
  const double shift_variance = 1.5 * 1.5 * (0.002 * 0.002 + 0.001 * 0.001);
  EXPECT_NEAR(on_slope.variance, 0.004 * 0.004 + std::pow(0.03 * 0.512, 2) + shift_variance, 1e-8);
}

TEST(MeasuredDepth, NothingAtEdgesHolesBordersAndFarAway) {
  const DepthSensorConfig config;
  cv::Mat1f depth(20, 30, 2.0F);
  depth(cv::Rect(20, 0, 10, 20)).setTo(3.0F);
  depth(10, 8) = kNone;
  EXPECT_FALSE(measureDepth(depth, {8, 10}, config).known());
  EXPECT_FALSE(measureDepth(depth, {9, 11}, config).known());
  EXPECT_TRUE(measureDepth(depth, {12, 10}, config).known());
  EXPECT_FALSE(measureDepth(depth, {19, 10}, config).known());
  EXPECT_FALSE(measureDepth(depth, {21, 10}, config).known());
  EXPECT_TRUE(measureDepth(depth, {24, 10}, config).known());
  EXPECT_FALSE(measureDepth(depth, {1, 10}, config).known());
  EXPECT_FALSE(measureDepth(depth, {29, 19}, config).known());
  EXPECT_FALSE(measureDepth(cv::Mat1f(20, 30, 11.0F), {10, 10}, config).known());
}

}  // namespace
}  // namespace mba_vo::measured_depth_test
