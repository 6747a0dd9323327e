#include "mba_vo/deblur/alignment.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace mba_vo::alignment_test {
namespace {

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

Eigen::Vector2f at(const cv::Mat2f& field, int row, int column) {
  return {field(row, column)[0], field(row, column)[1]};
}

TEST(Alignment, MeasuresAShift) {
  const Alignment alignment = measureAlignment(shifted(0, 0), shifted(0.3F, -0.4F), kAll);
  const std::vector<float> lengths = alignment.knownShifts();
  EXPECT_GT(lengths.size(), 150U);
  for (const float length : lengths) EXPECT_NEAR(length, 0.5F, 0.15F);
  EXPECT_LT((at(smoothShifts(alignment), 5, 7) - Eigen::Vector2f(0.3F, -0.4F)).norm(), 0.05F);
}

TEST(Alignment, BrightnessIsNoShift) {
  const Alignment alignment = measureAlignment(shifted(0, 0), cv::Mat1f(shifted(0, 0) + 9.0F), kAll);
  EXPECT_LT(at(smoothShifts(alignment), 5, 7).norm(), 0.03F);
}

TEST(Alignment, FollowsWhatChangesOverTheImage) {
  const cv::Mat2f field = smoothShifts(measureAlignment(shifted(0, 0), shifted(0.8F, 0.0F, true), kAll));
  EXPECT_NEAR(field(5, 2)[0], 0.0F, 0.1F);
  EXPECT_NEAR(field(5, 13)[0], 0.8F, 0.1F);
}

/// Upright stripes alone do not tell how far they moved along themselves; the blocks around, with all of the texture,
/// do.
TEST(Alignment, WhereEdgesTellOnlyOneDirectionTheBlocksAroundTellTheOther) {
  cv::Mat1f before = shifted(0, 0);
  cv::Mat1f after = shifted(0.3F, -0.4F);
  cv::RNG rng(6);
  for (int y = 64; y < 112; ++y) {
    for (int x = 96; x < 144; ++x) {
      const auto noise = [&] { return static_cast<float>(rng.gaussian(0.5)); };
      before(y, x) = 120.0F + 50.0F * std::sin(0.4F * static_cast<float>(x)) + noise();
      after(y, x) = 120.0F + 50.0F * std::sin(0.4F * (static_cast<float>(x) + 0.3F)) + noise();
    }
  }
  cv::Mat1f weight = kAll.clone();
  cv::rectangle(weight, cv::Rect(95, 63, 50, 50), 0.0F, 3);  // not the step around the stripes, which stays
  const Eigen::Vector2f shift = at(smoothShifts(measureAlignment(before, after, weight)), 5, 7);
  EXPECT_LT((shift - Eigen::Vector2f(0.3F, -0.4F)).norm(), 0.1F);
}

TEST(Alignment, WhereThereIsNoStructureOrNoWeightNothingIsTold) {
  EXPECT_TRUE(measureAlignment(cv::Mat1f(192, 256, 50.0F), shifted(0, 0), kAll).knownShifts().empty());
  const Alignment alignment = measureAlignment(shifted(0, 0), shifted(0.5F, 0), cv::Mat1f(192, 256, 0.0F));
  EXPECT_TRUE(alignment.knownShifts().empty());
  EXPECT_EQ(at(smoothShifts(alignment), 5, 7).norm(), 0.0F);
}

}  // namespace
}  // namespace mba_vo::alignment_test
