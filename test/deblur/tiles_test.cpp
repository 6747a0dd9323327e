#include "mba_vo/deblur/tiles.h"

#include <gtest/gtest.h>

namespace mba_vo::tiles_test {
namespace {

TEST(Tiles, CoverTheImageOnOneGrid) {
  for (const cv::Size image : {cv::Size(752, 480), cv::Size(640, 480), cv::Size(100, 700), cv::Size(1281, 33)}) {
    for (const cv::Size tile : {cv::Size(320, 256), cv::Size(64, 64), cv::Size(640, 480)}) {
      const Tiles tiles(image, tile, 32);
      EXPECT_GE(tiles.padded().width, image.width);
      EXPECT_GE(tiles.padded().height, image.height);
      cv::Mat1f sum(tiles.padded(), 0.0F);
      for (const cv::Rect& rect : tiles.all()) {
        EXPECT_EQ(rect.size(), tile);
        EXPECT_EQ(rect.x % 32 + rect.y % 32, 0);
        sum(rect) += tiles.weights(rect);
      }
      double least = 0.0;
      cv::minMaxLoc(sum, &least);
      EXPECT_GE(least, 0.99) << image << tile;
    }
  }
}

TEST(Tiles, AnImageOfTheirSizeIsOne) {
  const Tiles tiles({640, 480}, {640, 480}, 32);
  ASSERT_EQ(tiles.all().size(), 1U);
  EXPECT_EQ(cv::norm(tiles.weights(tiles.all()[0]), cv::Mat1f(480, 640, 1.0F), cv::NORM_INF), 0.0);
}

TEST(Tiles, InnerSidesAreNotUsedAndFade) {
  const Tiles tiles({512, 128}, {320, 128}, 32);
  ASSERT_EQ(tiles.all().size(), 2U);
  const cv::Mat1f left = tiles.weights(tiles.all()[0]);
  EXPECT_EQ(left(64, 0), 1.0F) << "the side of the image";
  EXPECT_LT(left(64, 319 - 10), 1e-5F);
  EXPECT_NEAR(left(64, 319 - 32), 0.5F, 0.02F);
  EXPECT_EQ(left(64, 319 - 60), 1.0F);
}

}  // namespace
}  // namespace mba_vo::tiles_test
