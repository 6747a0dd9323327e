#include "mba_vo/depth_search/surface_slope.h"

#include <gtest/gtest.h>

namespace mba_vo::surface_slope_test {
namespace {

const PinholeCamera kCamera{640, 480, 500.0, 500.0, 319.5, 239.5};
const Eigen::Vector2d kPlaneSlope(0.0012, -0.0008);

/// A slanted plane left of column 330, one twice as near and fronto-parallel right of it.
double inverseDepth(const Eigen::Vector2d& pixel) {
  return pixel.x() < 330.0 ? 0.5 + kPlaneSlope.dot(pixel - Eigen::Vector2d(300.0, 200.0)) : 1.0;
}

std::vector<ReferencePoint> points() {
  std::vector<ReferencePoint> points;
  for (int y = 100; y < 300; y += 11) {
    for (int x = 200; x < 450; x += 9) {
      const Eigen::Vector2d pixel(x + y % 3, y + x % 5);
      points.push_back({pixel.cast<float>(), static_cast<float>(inverseDepth(pixel)), 1e-6F});
    }
  }
  return points;
}

TEST(SurfaceSlopes, OfSlantedPlane) {
  const Eigen::Vector2d pixel(260.0, 190.0);
  const Eigen::Vector2d slope = SurfaceSlopes(kCamera, points()).at(pixel, inverseDepth(pixel), 1e-6);
  EXPECT_LT((slope - kPlaneSlope).norm(), 0.05 * kPlaneSlope.norm());
}

TEST(SurfaceSlopes, DoNotCrossDepthEdges) {
  const Eigen::Vector2d pixel(322.0, 190.0);
  const Eigen::Vector2d slope = SurfaceSlopes(kCamera, points()).at(pixel, inverseDepth(pixel), 1e-6);
  EXPECT_LT((slope - kPlaneSlope).norm(), 0.15 * kPlaneSlope.norm());
}

TEST(SurfaceSlopes, ZeroWithoutNeighbours) {
  EXPECT_TRUE(SurfaceSlopes(kCamera, points()).at({20.0, 20.0}, 0.5, 1e-6).isZero(0.0));
}

}  // namespace
}  // namespace mba_vo::surface_slope_test
