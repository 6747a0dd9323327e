#include "mba_vo/initialization/initializer_image.h"

#include <limits>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace mba_vo::initializer_image_test {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;

/// Grey, but for a hole in the middle.
FrameConstPtr frameWithHole(bool masked) {
  cv::Mat1f light(kHeight, kWidth, 120.0F);
  light(cv::Rect(150, 100, 40, 60)).setTo(std::numeric_limits<float>::quiet_NaN());
  auto frame = std::make_shared<Frame>();
  frame->masked = masked;
  frame->pyramid = ImagePyramid(light, {kWidth, kHeight, 300.0, 300.0, 159.5, 119.5}, 1);
  return frame;
}

/// Grey, but for its border and a wider corner.
FrameConstPtr rectifiedFrame() {
  constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
  cv::Mat1f light(kHeight, kWidth, 120.0F);
  cv::rectangle(light, cv::Rect(0, 0, kWidth, kHeight), kNothing);
  light(cv::Rect(0, 0, 60, 60)).setTo(kNothing);
  auto frame = std::make_shared<Frame>();
  frame->pyramid = ImagePyramid(light, {kWidth, kHeight, 300.0, 300.0, 159.5, 119.5}, 1);
  return frame;
}

TEST(InitializerImage, AMaskLeavesNoEdgesThatStayWhereTheyAre) {
  const InitializerImageConstPtr image = makeInitializerImage(frameWithHole(true));
  double darkest = 0.0;
  cv::minMaxLoc(image->grey, &darkest);
  EXPECT_EQ(darkest, 120.0);
  EXPECT_EQ(image->mask(130, 170), 0) << "but is no place for corners";
  EXPECT_EQ(image->mask(10, 10), 255);
}

TEST(InitializerImage, SmallHolesAreBlack) { EXPECT_EQ(makeInitializerImage(frameWithHole(false))->grey(130, 170), 0); }

TEST(InitializerImage, WhatRectificationLeavesOutIsAsBrightAsWhatIsNextToIt) {
  const InitializerImageConstPtr image = makeInitializerImage(rectifiedFrame());
  double darkest = 0.0;
  cv::minMaxLoc(image->grey, &darkest);
  EXPECT_EQ(darkest, 120.0);
  EXPECT_EQ(image->mask(130, 1), 0) << "but is no place for corners";
}

}  // namespace
}  // namespace mba_vo::initializer_image_test
