#include "mba_vo/image/spacing_grid.h"

#include <gtest/gtest.h>

namespace mba_vo::spacing_grid_test {
namespace {

TEST(SpacingGrid, HasRoomForOnePointPerCell) {
  const PinholeCamera camera{100, 60, 100.0, 100.0, 49.5, 29.5};
  SpacingGrid grid(camera, 10.0);
  EXPECT_TRUE(grid.isFree({25.0, 35.0}));
  grid.occupy({25.0, 35.0});
  EXPECT_FALSE(grid.isFree({20.0, 30.0}));
  EXPECT_FALSE(grid.isFree({29.9, 39.9}));
  EXPECT_TRUE(grid.isFree({30.1, 35.0}));
  EXPECT_TRUE(grid.isFree({25.0, 29.9}));
  // All pixels, the last row and column too, have a cell of their own.
  for (int y = 0; y < camera.height; y += 10) {
    for (int x = 0; x < camera.width; x += 10) grid.occupy({x, y});
  }
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) EXPECT_FALSE(grid.isFree({x, y})) << x << " " << y;
  }
}

/// Points that evenly textured images deliver at a spacing: one per cell.
int pointsAt(double distance_px) { return static_cast<int>(752.0 * 480.0 / (distance_px * distance_px)); }

TEST(AdaptedDistance, ReachesTheWantedNumberOfPointsFromBothSides) {
  for (const double begin : {2.0, 6.0, 30.0}) {
    for (const int wanted : {600, 2000, 8000}) {
      double distance = begin;
      for (int i = 0; i < 40; ++i) distance = adaptedDistance(distance, pointsAt(distance), wanted);
      EXPECT_NEAR(pointsAt(distance), wanted, 0.02 * wanted) << "from " << begin;
    }
  }
}

TEST(AdaptedDistance, ChangesSlowlyAndStaysInItsRange) {
  EXPECT_DOUBLE_EQ(adaptedDistance(10.0, 0, 2000), 8.0);
  EXPECT_DOUBLE_EQ(adaptedDistance(10.0, 1000000, 2000), 12.5);
  EXPECT_DOUBLE_EQ(adaptedDistance(10.0, 2000, 2000), 10.0);
  EXPECT_DOUBLE_EQ(adaptedDistance(2.0, 0, 2000), 2.0);
  EXPECT_DOUBLE_EQ(adaptedDistance(30.0, 1000000, 2000), 30.0);
}

}  // namespace
}  // namespace mba_vo::spacing_grid_test
