#include <gtest/gtest.h>

#include "deblur/two_frames.h"
#include "mba_vo/deblur/trajectory_deblurrer.h"

namespace mba_vo::two_frames_test {
namespace {

using test::crossedFrames;
using test::psnr;
using test::TwoFrames;

DeblurResult deblurWith(const DeblurInput& input, int frames) {
  TrajectoryDeblurConfig config;
  config.frames = frames;
  return TrajectoryDeblurrer(config).deblur(input);
}

cv::Mat1f sharpOf(const DeblurResult& result) { return result.image->level(0).intensity; }

/// As if there were no neighbour, to the last bit, and saying why.
void expectLikeOneFrame(const DeblurInput& input, const std::string& reason) {
  const DeblurResult two = deblurWith(input, 2);
  const DeblurResult one = deblurWith(input, 1);
  ASSERT_TRUE(one.sharpened) << one.reason;
  ASSERT_TRUE(two.sharpened) << two.reason;
  EXPECT_EQ(cv::norm(sharpOf(two), sharpOf(one), cv::NORM_INF), 0.0);
  EXPECT_EQ(two.residual, one.residual);
  EXPECT_FALSE(two.neighbour.sequence);
  EXPECT_EQ(two.neighbour.reason, reason);
}

TEST(TwoFrames, BlurredAcrossTheyAreWorthMuchMoreThanOne) {
  const TwoFrames& frames = crossedFrames();
  const DeblurResult two = deblurWith(frames.input, 2);
  ASSERT_TRUE(two.sharpened) << two.reason;
  EXPECT_EQ(two.neighbour.sequence, 42U) << two.neighbour.reason;
  EXPECT_LT(two.neighbour.shift_px, 0.2F);
  EXPECT_LT(two.neighbour.residual, 1.6F);
  const DeblurResult one = deblurWith(frames.input, 1);
  EXPECT_GT(psnr(sharpOf(two), frames.keyframe.sharp), psnr(sharpOf(one), frames.keyframe.sharp) + 2.0);
}

TEST(TwoFrames, OneThatIsTwoPixelsOffIsNotUsed) {
  DeblurInput input = crossedFrames().input;
  const cv::Mat1f image = input.neighbours[0].image->level(0).intensity;
  cv::Mat1f shifted;
  cv::copyMakeBorder(image, shifted, 0, 0, 2, 0, cv::BORDER_REPLICATE);
  input.neighbours[0].image = test::pyramidOf(shifted(cv::Rect({0, 0}, image.size())).clone());
  expectLikeOneFrame(input, "misaligned");
  EXPECT_GT(deblurWith(input, 2).neighbour.shift_px, 1.0F);
}

double psnrOf(const DeblurResult& result) { return psnr(sharpOf(result), crossedFrames().keyframe.sharp); }

TEST(TwoFrames, AShiftOfLessThanAPixelIsTakenAway) {
  DeblurInput input = crossedFrames().input;
  const double aligned = psnrOf(deblurWith(input, 2));
  const PinholeCamera camera = test::roomSimulator().camera();
  SE3& pose = input.neighbours[0].motion.T_reference_mid;
  pose = pose * SE3::exp((Vector6() << 0, 0, 0, 0.5 / camera.fy, 0.4 / camera.fx, 0).finished());
  const DeblurResult result = deblurWith(input, 2);
  ASSERT_EQ(result.neighbour.sequence, 42U) << result.neighbour.reason;
  EXPECT_NEAR(result.neighbour.shift_px, 0.64F, 0.2F);
  EXPECT_GT(psnrOf(result), aligned - 0.5);
}

TEST(TwoFrames, OneThatIsNotBlurredAsItIsSaidToBeDoesNoHarm) {
  DeblurInput input = crossedFrames().input;
  input.neighbours[0].motion.velocity(3) *= 0.5;
  EXPECT_GT(psnrOf(deblurWith(input, 2)), psnrOf(deblurWith(input, 1)) - 0.1);
}

TEST(TwoFrames, WhatHasMovedInTheOtherFrameDoesNoHarm) {
  DeblurInput input = crossedFrames().input;
  cv::Mat1f spoilt = input.neighbours[0].image->level(0).intensity.clone();
  spoilt(cv::Rect(100, 70, 80, 60)).setTo(90.0F);
  input.neighbours[0].image = test::pyramidOf(spoilt);
  const DeblurResult two = deblurWith(input, 2);
  ASSERT_EQ(two.neighbour.sequence, 42U) << two.neighbour.reason;
  const cv::Rect there(110, 80, 60, 40);
  const cv::Mat1b truth = crossedFrames().keyframe.sharp(there);
  EXPECT_GT(psnr(sharpOf(two)(there), truth), psnr(sharpOf(deblurWith(input, 1))(there), truth) - 0.5);
}

TEST(TwoFrames, OneBlurredAlikeIsNotWorthIt) {
  DeblurInput input = crossedFrames().input;
  input.neighbours[0].motion.velocity = 3.0 * input.motion.velocity;
  expectLikeOneFrame(input, "blurred alike");
}

TEST(TwoFrames, WithoutNeighboursThereIsOne) {
  DeblurInput input = crossedFrames().input;
  input.neighbours.clear();
  expectLikeOneFrame(input, "no neighbour");
}

TEST(TwoFrames, TheBrightnessOfTheOtherFrameDoesNotMatter) {
  DeblurInput input = crossedFrames().input;
  DeblurNeighbour& neighbour = input.neighbours[0];
  neighbour.gain = 0.6;
  neighbour.offset = 15.0;
  neighbour.image = test::pyramidOf(test::scaled(neighbour.image->level(0).intensity, 0.6, 15.0));
  const DeblurResult two = deblurWith(input, 2);
  EXPECT_EQ(two.neighbour.sequence, 42U) << two.neighbour.reason;
  EXPECT_NEAR(psnr(sharpOf(two), crossedFrames().keyframe.sharp),
              psnr(sharpOf(deblurWith(crossedFrames().input, 2)), crossedFrames().keyframe.sharp), 0.1);
}

}  // namespace
}  // namespace mba_vo::two_frames_test
