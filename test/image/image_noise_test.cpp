#include "mba_vo/image/image_noise.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace mba_vo::image_noise_test {
namespace {

/// Slopes and edges as a blurred image has them, with noise and whole grey levels.
cv::Mat1f noisyImage(double sigma) {
  cv::Mat1f image(240, 320);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      image(y, x) =
          60.0F + 0.2F * static_cast<float>(x) + (x / 40 % 2 == 0 ? 30.0F : 0.0F) + (y / 60 % 2 == 0 ? 20.0F : 0.0F);
    }
  }
  cv::Mat1f noise(image.size());
  cv::RNG(7).fill(noise, cv::RNG::NORMAL, 0.0, sigma);
  image += noise;
  cv::Mat1b rounded;
  image.convertTo(rounded, CV_8U);
  rounded.convertTo(image, CV_32F);
  return image;
}

TEST(ImageNoise, IsFoundBesideEdges) {
  for (const double sigma : {0.5, 1.0, 3.0, 8.0}) {
    const double expected = std::sqrt(sigma * sigma + 1.0 / 12.0);  // of rounding
    EXPECT_NEAR(estimateNoise(noisyImage(sigma)), expected, 0.15 * expected) << sigma;
  }
}

TEST(ImageNoise, OfANoiselessImageIsThatOfRounding) {
  EXPECT_NEAR(estimateNoise(cv::Mat1f(40, 40, 17.0F)), 0.289F, 1e-3F);
}

TEST(ImageNoise, InvalidPixelsDoNotCount) {
  cv::Mat1f image = noisyImage(2.0);
  image(cv::Rect(50, 50, 100, 100)).setTo(std::numeric_limits<float>::quiet_NaN());
  EXPECT_NEAR(estimateNoise(image), 2.0F, 0.25F);
}

}  // namespace
}  // namespace mba_vo::image_noise_test
