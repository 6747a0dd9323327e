#include "mba_vo/deblur/dense_inverse_depth.h"

#include <cmath>

#include <gtest/gtest.h>

#include "support/random.h"

namespace mba_vo::dense_inverse_depth_test {
namespace {

const PinholeCamera kCamera{203, 150, 200.0, 200.0, 101.0, 74.5};

/// A slanted wall, and in front of it a box from x = 80 to 140.
float trueInverseDepth(float x, float y) {
  if (x > 80.0F && x < 140.0F) return 0.8F;
  return 0.3F + 0.0004F * x + 0.0003F * y;
}

std::vector<DepthSample> samples(int count, double noise, double outliers) {
  test::Random random(5);
  std::vector<DepthSample> result;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2f pixel(static_cast<float>(random.uniform(0.0, 202.0)),
                                static_cast<float>(random.uniform(0.0, 149.0)));
    float w = trueInverseDepth(pixel.x(), pixel.y()) * static_cast<float>(1.0 + random.normal(noise));
    if (random.uniform(0.0, 1.0) < outliers) w *= static_cast<float>(random.uniform(1.5, 4.0));
    result.push_back({pixel, w});
  }
  return result;
}

/// Relative error, median and share of pixels above 10 %.
std::pair<double, double> errors(const cv::Mat1f& dense) {
  std::vector<double> all;
  double bad = 0.0;
  for (int y = 0; y < dense.rows; ++y) {
    for (int x = 0; x < dense.cols; ++x) {
      const float truth = trueInverseDepth(static_cast<float>(x), static_cast<float>(y));
      all.push_back(static_cast<double>(std::abs(dense(y, x) / truth - 1.0F)));
      bad += all.back() > 0.1 ? 1.0 : 0.0;
    }
  }
  std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2), all.end());
  return {all[all.size() / 2], bad / static_cast<double>(all.size())};
}

TEST(DenseInverseDepth, FollowsSlantedSurfacesAndKeepsEdges) {
  const cv::Mat1f dense = denseInverseDepth(kCamera, samples(400, 0.01, 0.0));
  ASSERT_EQ(dense.size(), cv::Size(kCamera.width, kCamera.height));
  const auto [median, bad] = errors(dense);
  EXPECT_LT(median, 0.01);
  EXPECT_LT(bad, 0.12);  // within 6 px of the two edges
}

TEST(DenseInverseDepth, DoesNotMindOutliers) {
  const auto [median, bad] = errors(denseInverseDepth(kCamera, samples(400, 0.01, 0.1)));
  EXPECT_LT(median, 0.015);
  EXPECT_LT(bad, 0.2);
}

TEST(DenseInverseDepth, IsPositiveFarFromAnySample) {
  const cv::Mat1f dense =
      denseInverseDepth(kCamera, {{{10.0F, 10.0F}, 0.5F}, {{12.0F, 10.0F}, 0.45F}, {{14.0F, 11.0F}, 0.4F}});
  double low = 0.0;
  double high = 0.0;
  cv::minMaxLoc(dense, &low, &high);
  EXPECT_GT(low, 0.3);
  EXPECT_LT(high, 0.6);
}

TEST(DenseInverseDepth, OneSampleIsADepthForAll) {
  const cv::Mat1f dense = denseInverseDepth(kCamera, {{{300.0F, -20.0F}, 0.5F}});
  EXPECT_LT(cv::norm(dense, cv::Mat1f(dense.size(), 0.5F), cv::NORM_INF), 1e-3);
}

TEST(DenseInverseDepth, WithoutUsableSamplesThereIsNone) {
  EXPECT_TRUE(denseInverseDepth(kCamera, {}).empty());
  EXPECT_TRUE(denseInverseDepth(kCamera, {{{5.0F, 5.0F}, -1.0F}, {{6.0F, 5.0F}, NAN}}).empty());
}

}  // namespace
}  // namespace mba_vo::dense_inverse_depth_test
