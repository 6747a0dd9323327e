#include "mba_vo/image/white_level.h"

#include <gtest/gtest.h>

namespace mba_vo::white_level_test {
namespace {

cv::Mat imageWith(int largest) {
  cv::Mat1w image(8, 8, std::uint16_t{7});
  image(3, 4) = static_cast<std::uint16_t>(largest);
  return image;
}

TEST(WhiteLevel, IsTheLowestThatHoldsAllValues) {
  for (const int white : {1023, 4095, 16383, 65535}) EXPECT_EQ(WhiteLevel(0.0).of(imageWith(white)), white);
  EXPECT_EQ(WhiteLevel(0.0).of(imageWith(0)), 1023.0);
  EXPECT_EQ(WhiteLevel(0.0).of(imageWith(1024)), 4095.0);
  EXPECT_EQ(WhiteLevel(0.0).of(imageWith(65520)), 65535.0);  // 12 bits to the left
}

TEST(WhiteLevel, GrowsAndDoesNotShrink) {
  WhiteLevel white(0.0);
  EXPECT_EQ(white.found(), 0.0);
  EXPECT_EQ(white.of(imageWith(900)), 1023.0);
  EXPECT_EQ(white.of(imageWith(3000)), 4095.0);
  EXPECT_EQ(white.of(imageWith(900)), 4095.0);
  EXPECT_EQ(white.found(), 4095.0);
}

TEST(WhiteLevel, WhatIsToldHoldsForSixteenBitsAlone) {
  WhiteLevel white(4000.0);
  EXPECT_EQ(white.of(imageWith(65535)), 4000.0);
  EXPECT_EQ(white.of(cv::Mat1b(8, 8, std::uint8_t{3})), 255.0);
}

TEST(WhiteLevel, OpacityIsNoLight) {
  EXPECT_EQ(WhiteLevel(0.0).of(cv::Mat(8, 8, CV_16UC4, cv::Scalar(100, 3000, 100, 65535))), 4095.0);
  EXPECT_EQ(WhiteLevel(0.0).of(cv::Mat(8, 8, CV_16UC3, cv::Scalar(100, 100, 3000))), 4095.0);
}

}  // namespace
}  // namespace mba_vo::white_level_test
