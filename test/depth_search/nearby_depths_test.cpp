#include "mba_vo/depth_search/nearby_depths.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "support/random.h"

namespace mba_vo::nearby_depths_test {
namespace {

/// Of a slanted plane.
double trueInverseDepth(double x, double y) { return 0.4 + 4e-4 * x + 2e-4 * y; }

std::vector<ReferencePoint> pointsBetween(float left, float right, int count = 600) {
  test::Random random(1);
  std::vector<ReferencePoint> points;
  for (int i = 0; i < count; ++i) {
    const double x = random.uniform(static_cast<double>(left), static_cast<double>(right));
    const double y = random.uniform(8.0, 232.0);
    points.push_back({Eigen::Vector2d(x, y).cast<float>(), static_cast<float>(trueInverseDepth(x, y)), 1e-4F});
  }
  return points;
}

TEST(NearbyDepths, AreNearTheTruthBetweenPoints) {
  const NearbyDepths depths(pointsBetween(8.0F, 368.0F));
  ASSERT_TRUE(depths.known());
  for (int y = 30; y < 220; y += 20) {
    for (int x = 30; x < 350; x += 20) {
      EXPECT_NEAR(depths.at({x, y}).inverse_depth / trueInverseDepth(x, y), 1.0, 0.05) << x << " " << y;
    }
  }
}

TEST(NearbyDepths, FarAwayStayWithinThoseOfThePoints) {
  const std::vector<ReferencePoint> points = pointsBetween(8.0F, 100.0F);
  const auto [least, most] = std::minmax_element(
      points.begin(), points.end(), [](const auto& l, const auto& r) { return l.inverse_depth < r.inverse_depth; });
  const double far = NearbyDepths(points).at({360.0, 120.0}).inverse_depth;
  EXPECT_GE(far, static_cast<double>(least->inverse_depth));
  EXPECT_LE(far, static_cast<double>(most->inverse_depth));
}

TEST(NearbyDepths, AreLessCertainBetweenSurfaces) {
  std::vector<ReferencePoint> points = pointsBetween(8.0F, 368.0F);
  for (ReferencePoint& point : points) point.inverse_depth = point.pixel.x() < 180.0F ? 0.2F : 1.0F;
  const NearbyDepths depths(points);
  const DepthGuess within = depths.at({40.0, 120.0});
  const DepthGuess between = depths.at({180.0, 120.0});
  EXPECT_NEAR(within.inverse_depth, 0.2, 0.02);
  EXPECT_LT(within.sigma, 0.1);
  EXPECT_GT(within.sigma, 0.02) << "nothing says that there is no third surface";
  EXPECT_GT(between.sigma, 0.25);
}

TEST(NearbyDepths, AreNotKnownFromAFewPoints) {
  EXPECT_FALSE(NearbyDepths({}).known());
  EXPECT_FALSE(NearbyDepths(pointsBetween(8.0F, 368.0F, 5)).known());
}

}  // namespace
}  // namespace mba_vo::nearby_depths_test
