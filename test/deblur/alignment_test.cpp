#include "mba_vo/deblur/alignment.h"

#include <cmath>

#include <gtest/gtest.h>

namespace mba_vo {
namespace {

constexpr float kNoLimit = 100.0F;  // [px]

float texture(float x, float y) {
  return 120.0F + 40.0F * std::sin(0.35F * x) + 30.0F * std::cos(0.27F * y) + 15.0F * std::sin(0.2F * (x + y));
}

/// Sampled at x + shift, with some noise; shifted in the right half only if `half`.
cv::Mat1f shifted(float dx, float dy, bool half = false) {
  cv::Mat1f image(192, 256);
  cv::RNG rng(5);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const float on = half && x < 128 ? 0.0F : 1.0F;
      image(y, x) = texture(static_cast<float>(x) + on * dx, static_cast<float>(y) + on * dy) +
                    static_cast<float>(rng.gaussian(0.5));
    }
  }
  return image;
}

const cv::Mat1f kAll(192, 256, 1.0F);

TEST(Alignment, MeasuresAShift) {
  const Alignment alignment = measureAlignment(shifted(0, 0), shifted(0.3F, -0.4F), kAll, kNoLimit);
  EXPECT_EQ(alignment.blocks, 48);
  EXPECT_NEAR(alignment.shift_px, 0.5F, 0.03F);
}

TEST(Alignment, BrightnessIsNoShift) {
  EXPECT_LT(measureAlignment(shifted(0, 0), cv::Mat1f(shifted(0, 0) + 9.0F), kAll, kNoLimit).shift_px, 0.03F);
}

TEST(Alignment, KnowsTheBlocks) {
  const Alignment alignment = measureAlignment(shifted(0, 0), shifted(1.0F, 0.0F, true), kAll, 0.5F);
  EXPECT_EQ(alignment.misaligned(2, 1), 0);
  EXPECT_EQ(alignment.misaligned(2, 6), 255);
  EXPECT_EQ(cv::countNonZero(alignment.misaligned), 24);
}

TEST(Alignment, WhereThereIsNoStructureOrNoWeightNothingIsTold) {
  EXPECT_EQ(measureAlignment(cv::Mat1f(192, 256, 50.0F), shifted(0, 0), kAll, kNoLimit).blocks, 0);
  EXPECT_EQ(measureAlignment(shifted(0, 0), shifted(0, 0), cv::Mat1f(192, 256, 0.0F), kNoLimit).blocks, 0);
}

}  // namespace
}  // namespace mba_vo
