#include "mba_vo/deblur/neighbour_choice.h"

#include <gtest/gtest.h>

namespace mba_vo::neighbour_choice_test {
namespace {

using Paths = std::vector<Eigen::Vector2f>;

const PinholeCamera kCamera{376, 240, 260.0, 260.0, 187.5, 119.5};
constexpr double kExposure = 0.02;  // [s]
constexpr float kNoise = 1.0F;      // [grey levels]

/// A turn that smears the middle of the image by x, y [px].
DeblurNeighbour frameBlurredBy(double x, double y) {
  DeblurNeighbour frame;
  frame.image = std::make_shared<const ImagePyramid>(cv::Mat1f(240, 376, 100.0F), kCamera, 1);
  frame.motion.exposure = kExposure;
  frame.motion.velocity << 0, 0, 0, -y / (kCamera.fy * kExposure), x / (kCamera.fx * kExposure), 0;
  return frame;
}

std::optional<NeighbourChoice> choose(const DeblurNeighbour& keyframe, const std::vector<DeblurNeighbour>& others) {
  return chooseNeighbour({kCamera, kCamera, keyframe.motion}, cv::Mat1f(240, 376, 0.5F), kNoise, others);
}

TEST(ExpectedError, WithoutBlurItIsThatOfTheNoiseAndHalfOfItWithTwoImages) {
  const double one = expectedError({{0.0F, 0.0F}}, 0.1F);  // so little noise that no prior matters
  EXPECT_NEAR(one, 0.01, 2e-4);
  EXPECT_NEAR(expectedError({{0.0F, 0.0F}, {0.0F, 0.0F}}, 0.1F), 0.005, 1e-4);
}

TEST(ExpectedError, GrowsWithTheBlurAndTheNoise) {
  const double shorter = expectedError({{5.0F, 0.0F}}, kNoise);
  const double longer = expectedError({{15.0F, 0.0F}}, kNoise);
  EXPECT_GT(longer, 1.2 * shorter);
  EXPECT_GT(expectedError({{15.0F, 0.0F}}, 3.0F), 1.2 * longer);
}

TEST(ExpectedError, AnotherDirectionHelpsMoreThanTheSameAndShorterMoreThanLonger) {
  const Eigen::Vector2f own(15.0F, 0.0F);
  const double alone = expectedError({own}, kNoise);
  const double alike = expectedError({own, own}, kNoise);
  const double across = expectedError({own, {0.0F, 15.0F}}, kNoise);
  const double slanted = expectedError({own, {13.0F, 7.5F}}, kNoise);
  const double shorter = expectedError({own, {5.0F, 0.0F}}, kNoise);
  EXPECT_LT(alike, alone);
  EXPECT_LT(across, 0.85 * alike);
  EXPECT_LT(slanted, alike);
  EXPECT_LT(across, slanted);
  EXPECT_LT(shorter, alike);
}

TEST(ChooseNeighbour, TakesTheOneBlurredAcross) {
  const auto choice =
      choose(frameBlurredBy(14, 0), {frameBlurredBy(14, 1), frameBlurredBy(2, 14), frameBlurredBy(-20, 3)});
  ASSERT_TRUE(choice);
  EXPECT_EQ(choice->index, 1U);
  EXPECT_GT(choice->gain_db, 1.0);
}

TEST(ChooseNeighbour, TakesASharpOneBeforeAnyOther) {
  const auto choice = choose(frameBlurredBy(14, 0), {frameBlurredBy(0, 14), frameBlurredBy(0.5, 0)});
  ASSERT_TRUE(choice);
  EXPECT_EQ(choice->index, 1U);
}

TEST(ChooseNeighbour, WhatLooksElsewhereTellsNothing) {
  DeblurNeighbour elsewhere = frameBlurredBy(0, 14);
  elsewhere.motion.T_reference_mid = SE3::exp((Vector6() << 0, 0, 0, 0, 1.3, 0).finished());
  const auto alone = choose(frameBlurredBy(14, 0), {elsewhere});
  ASSERT_TRUE(alone);
  EXPECT_NEAR(alone->gain_db, 0.0, 1e-6);
  const auto choice = choose(frameBlurredBy(14, 0), {elsewhere, frameBlurredBy(14, 1)});
  EXPECT_EQ(choice->index, 1U);
}

TEST(ChooseNeighbour, TakesNoneWithoutAnImageOrWithAnImpossibleGain) {
  DeblurNeighbour no_image = frameBlurredBy(0, 14);
  no_image.image.reset();
  DeblurNeighbour dark = frameBlurredBy(0, 14);
  dark.gain = 0.0;
  EXPECT_FALSE(choose(frameBlurredBy(14, 0), {no_image, dark}));
  EXPECT_FALSE(choose(frameBlurredBy(14, 0), {}));
}

}  // namespace
}  // namespace mba_vo::neighbour_choice_test
