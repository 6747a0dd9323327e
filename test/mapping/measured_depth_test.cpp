#include "mba_vo/mapping/measured_depth.h"

#include <cmath>

#include <gtest/gtest.h>

namespace mba_vo {
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

constexpr double kPrecision = 0.5;  // [1 / grey level^2]

TEST(MeasuredDepth, DerivativesAreThoseOfTheCost) {
  const MeasuredDepth measured{0.5, 1e-4};
  for (const double d : {0.3, 0.47, 0.499, 0.5, 0.52, 0.9}) {
    constexpr double kStep = 1e-6;
    const double slope = (measuredDepthTerm(measured, d + kStep, kPrecision).cost -
                          measuredDepthTerm(measured, d - kStep, kPrecision).cost) /
                         (2.0 * kStep);
    const MeasuredDepthTerm term = measuredDepthTerm(measured, d, kPrecision);
    EXPECT_NEAR(2.0 * term.b, slope, 1e-4 * (1.0 + std::abs(slope))) << d;
    EXPECT_NEAR(term.b, term.H * (d - 0.5), 1e-9 * (1.0 + std::abs(term.b))) << d;
  }
  // Near the measurement a deviation of one sigma costs as much as the variance of one residual, far away hardly more.
  EXPECT_NEAR(measuredDepthTerm(measured, 0.501, kPrecision).cost, kPrecision * 25.0 * 0.01, 1e-3);
  EXPECT_LT(measuredDepthTerm(measured, 2.5, kPrecision).b, 0.2 * measuredDepthTerm(measured, 0.53, kPrecision).b);
  EXPECT_EQ(measuredDepthTerm({}, 0.7, kPrecision).cost, 0.0);
  EXPECT_EQ(measuredDepthTerm({}, 0.7, kPrecision).H, 0.0);
}

}  // namespace
}  // namespace mba_vo
