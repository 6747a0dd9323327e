#include "mba_vo/simulation/texture.h"

#include <cmath>

#include <gtest/gtest.h>

#include "mba_vo/simulation/texture_painter.h"

namespace mba_vo::texture_test {
namespace {

TEST(Texture, InterpolatesRepeatsAndAverages) {
  cv::Mat1f image(4, 4, 0.0F);
  image(1, 2) = 0.8F;
  const Texture texture(image);
  EXPECT_NEAR(texture.sample(2.0F, 1.0F, 0.0F), 0.8, 1e-4);
  EXPECT_NEAR(texture.sample(2.25F, 1.0F, -3.0F), 0.6, 1e-4);
  EXPECT_NEAR(texture.sample(2.0F - 4.0F, 1.0F + 8.0F, 0.0F), 0.8, 1e-4);
  EXPECT_NEAR(texture.sample(2.5F, 0.5F, 1.0F), 0.2, 1e-4);    // one texel of the second level covers four
  EXPECT_NEAR(texture.sample(0.3F, 0.7F, 50.0F), 0.05, 1e-4);  // everything
}

TEST(Texture, RefusesSidesThatDoNotRepeat) {
  EXPECT_THROW(Texture(cv::Mat1f(4, 8, 0.0F)), std::invalid_argument);
  EXPECT_THROW(Texture(cv::Mat1f(6, 6, 0.0F)), std::invalid_argument);
}

TEST(TexturePainter, EveryPatternHasContrastInRange) {
  for (int i = 0; i < kPatterns; ++i) {
    cv::RNG random(5);
    const cv::Mat1f image = paintPattern(static_cast<Pattern>(i), 128, random);
    double lowest, highest;
    cv::minMaxLoc(image, &lowest, &highest);
    EXPECT_GE(lowest, 0.0);
    EXPECT_LE(highest, 1.0);
    EXPECT_GT(highest - lowest, i == 0 ? 0.05 : 0.3) << "pattern " << i;  // plaster is nearly plain
  }
}

}  // namespace
}  // namespace mba_vo::texture_test
