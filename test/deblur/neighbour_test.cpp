#include "mba_vo/deblur/neighbour.h"

#include <cmath>

#include <gtest/gtest.h>

#include "deblur/transpose_check.h"
#include "deblur/two_frames.h"
#include "mba_vo/deblur/blur_operator.h"

namespace mba_vo::neighbour_test {
namespace {

using test::crossedFrames;
using test::roomSimulator;
using test::toFloat;
using test::TwoFrames;

BlurOperator neighbourOperator(const TwoFrames& frames) {
  return {test::geometryOf(frames), test::trueInverseDepth(frames.keyframe),
          BlurOperator::gridFor(roomSimulator().camera(), 12)};
}

cv::Mat1f overlayOf(const TwoFrames& frames, const DeblurNeighbour& neighbour) {
  return overlay({&neighbour, 0, test::geometryOf(frames), {}}, test::trueInverseDepth(frames.keyframe),
                 denseInverseDepth(neighbour, roomSimulator().camera(), frames.input.depths));
}

TEST(Neighbour, ItsOperatorHasAnExactTranspose) { test::expectExactTranspose(neighbourOperator(crossedFrames())); }

/// What the operator makes of the rendered sharp keyframe is the rendered neighbour, up to noise, depth edges and
/// tiles. Returns the rms [grey levels] over pixels off the border.
double rmsAgainstRendered(const TwoFrames& frames, const cv::Mat1f& laid_over) {
  const BlurOperator blur = neighbourOperator(frames);
  const int margin = blur.grid().margin;
  const cv::Mat1f sharp = toFloat(frames.keyframe.sharp);
  cv::Mat1f latent;
  cv::copyMakeBorder(sharp, latent, margin, blur.grid().size.height - margin - sharp.rows, margin,
                     blur.grid().size.width - margin - sharp.cols, cv::BORDER_REPLICATE);
  cv::Mat1f predicted;
  blur.apply(latent, predicted);
  double sum = 0.0;
  int count = 0;
  for (int y = 16; y < sharp.rows - 16; ++y) {
    for (int x = 16; x < sharp.cols - 16; ++x) {
      const double difference = static_cast<double>(predicted(y, x) - laid_over(y, x));
      if (!std::isfinite(difference)) continue;
      sum += difference * difference;
      ++count;
    }
  }
  EXPECT_GT(count, sharp.rows * sharp.cols / 2);
  return std::sqrt(sum / count);
}

TEST(Neighbour, ItsOperatorPredictsTheRenderedNeighbour) {
  const TwoFrames& frames = crossedFrames();
  const cv::Mat1f laid_over = overlayOf(frames, frames.input.neighbours[0]);
  EXPECT_LT(rmsAgainstRendered(frames, laid_over), 2.0);  // noise of two images: 1.4
  // By the keyframe's own motion it would not.
  TwoFrames wrong = frames;
  wrong.input.neighbours[0].motion.velocity = frames.input.motion.velocity;
  EXPECT_GT(rmsAgainstRendered(wrong, laid_over), 4.0);
}

TEST(Neighbour, BrightnessIsUndone) {
  const TwoFrames& frames = crossedFrames();
  DeblurNeighbour darker = frames.input.neighbours[0];
  const cv::Mat1f expected = overlayOf(frames, darker);
  darker.gain = 0.7;
  darker.offset = 12.0;
  darker.image = test::pyramidOf(test::scaled(darker.image->level(0).intensity, 0.7, 12.0));
  const cv::Mat1f laid_over = overlayOf(frames, darker);
  for (int y = 20; y < expected.rows; y += 40) {
    for (int x = 20; x < expected.cols; x += 40) {
      if (!std::isfinite(expected(y, x))) continue;
      EXPECT_NEAR(laid_over(y, x), expected(y, x), 0.01);
    }
  }
}

/// The pixel of the neighbour that sees what a pixel of the keyframe sees.
Eigen::Vector2d inNeighbour(const TwoFrames& frames, const Eigen::Vector2d& pixel, double depth) {
  const PinholeCamera camera = roomSimulator().camera();
  return camera.project(frames.input.neighbours[0].motion.T_reference_mid.inverse() *
                        (depth * camera.unproject(pixel)));
}

TEST(Neighbour, SaturatedAndInvalidPixelsHaveNoValue) {
  const TwoFrames& frames = crossedFrames();
  const Eigen::Vector2d lamp = inNeighbour(frames, {120, 80}, static_cast<double>(frames.keyframe.depth(80, 120)));
  const Eigen::Vector2d gap = inNeighbour(frames, {250, 150}, static_cast<double>(frames.keyframe.depth(150, 250)));
  cv::Mat1f spoilt = frames.input.neighbours[0].image->level(0).intensity.clone();
  spoilt(cv::Rect(static_cast<int>(lamp.x()) - 4, static_cast<int>(lamp.y()) - 4, 9, 9)).setTo(255.0F);
  spoilt(static_cast<int>(gap.y()), static_cast<int>(gap.x())) = std::nanf("");
  DeblurNeighbour neighbour = frames.input.neighbours[0];
  neighbour.image = test::pyramidOf(spoilt);
  const cv::Mat1f laid_over = overlayOf(frames, neighbour);
  EXPECT_TRUE(std::isnan(laid_over(80, 120)));
  EXPECT_TRUE(std::isnan(laid_over(150, 250)));
  const cv::Mat1f clean = overlayOf(frames, frames.input.neighbours[0]);
  EXPECT_TRUE(std::isfinite(clean(80, 120)));
  EXPECT_TRUE(std::isfinite(clean(150, 250)));
}

/// Against the renderer's depths in both images: a large step to the side, so that near things hide far ones.
TEST(Neighbour, WhatIsHiddenHasNoValue) {
  const TwoFrames frames =
      test::makeTwoFrames(Vector6::Zero(), SE3(Eigen::Quaterniond::Identity(), {0.35, 0.0, 0.0}), Vector6::Zero());
  const cv::Mat1f laid_over = overlayOf(frames, frames.input.neighbours[0]);
  const PinholeCamera camera = roomSimulator().camera();
  int hidden = 0, hidden_used = 0, visible = 0, visible_used = 0;
  for (int y = 2; y < camera.height; y += 3) {
    for (int x = 2; x < camera.width; x += 3) {
      const auto depth = static_cast<double>(frames.keyframe.depth(y, x));
      const Eigen::Vector2d pixel = inNeighbour(frames, {x, y}, depth);
      if (!camera.contains(pixel, 6.0)) continue;
      const auto there = static_cast<double>(
          frames.neighbour.depth(static_cast<int>(std::lround(pixel.y())), static_cast<int>(std::lround(pixel.x()))));
      const double parallax = camera.fx * 0.35 * (1.0 / there - 1.0 / depth);  // [px]
      const bool used = std::isfinite(laid_over(y, x));
      if (parallax > 5.0) ++hidden, hidden_used += used ? 1 : 0;
      if (std::abs(parallax) < 0.3) ++visible, visible_used += used ? 1 : 0;
    }
  }
  ASSERT_GT(hidden, 100);
  EXPECT_LT(hidden_used, 0.25 * hidden);
  EXPECT_GT(visible_used, 0.8 * visible);
}

}  // namespace
}  // namespace mba_vo::neighbour_test
