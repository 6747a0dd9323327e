#include "mba_vo/image/image_content.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

namespace mba_vo::image_content_test {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;

ImagePyramid pyramidOf(const cv::Mat1f& image, double gain = 1.0) {
  PinholeCamera camera;
  camera.width = image.cols;
  camera.height = image.rows;
  camera.fx = camera.fy = 300.0;
  camera.cx = 0.5 * image.cols;
  camera.cy = 0.5 * image.rows;
  return {image, camera, 5, gain};
}

cv::Mat1f filled(const std::function<double(int x, int y)>& value) {
  cv::Mat1f image(kHeight, kWidth);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) image(y, x) = static_cast<float>(value(x, y));
  }
  return image;
}

cv::Mat1f noise(double mean, double sigma, int seed) {
  cv::Mat1f image(kHeight, kWidth);
  cv::RNG(static_cast<std::uint64_t>(seed)).fill(image, cv::RNG::NORMAL, mean, sigma);
  return image;
}

/// Waves of 60 px, 80 grey levels from trough to crest.
double waves(int x, int y) { return 100.0 + 40.0 * std::sin(x / 9.5) * std::cos(y / 9.5); }

TEST(ImageContent, GradientOfARamp) {
  const ImagePyramid ramp = pyramidOf(filled([](int x, int y) { return 0.3 * x + 0.4 * y; }));
  // Of 0.3 and 0.4 along x and y the rms along one direction is sqrt((0.09 + 0.16) / 2).
  EXPECT_NEAR(rmsGradient(ramp.level(0), {{50.0, 60.0}, {0.0, 0.0}, {319.0, 239.0}}), std::sqrt(0.125), 1e-4);
}

TEST(ImageContent, InvalidPixelsAndPlacesOutsideDoNotCount) {
  cv::Mat1f image = filled([](int x, int) { return 2.0 * x; });
  image(cv::Rect(100, 100, 40, 40)).setTo(std::nanf(""));
  const ImagePyramid pyramid = pyramidOf(image);
  EXPECT_NEAR(rmsGradient(pyramid.level(0), {{98.0, 110.0}, {-20.0, 5.0}, {1e9, 1e9}, {std::nan(""), 3.0}}),
              std::sqrt(2.0), 1e-4);
  EXPECT_EQ(rmsGradient(pyramid.level(0), {{120.0, 120.0}}), 0.0);
  EXPECT_EQ(rmsGradient(pyramid.level(0), {}), 0.0);
}

TEST(ImageContent, BlackSaturatedAndCoveredImagesShowNothing) {
  EXPECT_FALSE(hasContent(pyramidOf(cv::Mat1f(kHeight, kWidth, 0.0F))));
  EXPECT_FALSE(hasContent(pyramidOf(cv::Mat1f(kHeight, kWidth, 255.0F))));
  EXPECT_FALSE(hasContent(pyramidOf(noise(12.0, 2.0, 1))));
  EXPECT_FALSE(hasContent(pyramidOf(cv::Mat1f(kHeight, kWidth, std::nanf("")))));
  EXPECT_FALSE(hasContent(ImagePyramid()));
  EXPECT_TRUE(hasContent(pyramidOf(filled(waves))));
  // Eight times darker, it is the same scene.
  EXPECT_TRUE(hasContent(pyramidOf(filled([](int x, int y) { return waves(x, y) / 8.0; }))));
}

TEST(ImageContent, NoiseIsNoContentWhateverItsGain) {
  EXPECT_FALSE(hasContent(pyramidOf(noise(48.0, 8.0, 1), 4.0)));
  EXPECT_TRUE(hasContent(pyramidOf(filled(waves), 4.0)));
}

TEST(ImageContent, BrightnessIsThatBeforeTheGain) {
  cv::Mat1f image(kHeight, kWidth, 90.0F);
  EXPECT_NEAR(meanBrightness(pyramidOf(image, 2.0)), 45.0, 1e-3);
  image(cv::Rect(0, 0, 160, kHeight)).setTo(std::nanf(""));
  EXPECT_NEAR(meanBrightness(pyramidOf(image)), 90.0, 1e-3);
  EXPECT_EQ(meanBrightness(ImagePyramid()), 0.0);
}

TEST(ImageContent, ContrastFollowsTheExposure) {
  const double bright = contrast(pyramidOf(filled(waves)));
  const double dark = contrast(pyramidOf(filled([](int x, int y) { return waves(x, y) / 8.0; })));
  EXPECT_GT(bright, 10.0);
  EXPECT_NEAR(bright / dark, 8.0, 0.01);
  EXPECT_NEAR(contrast(pyramidOf(cv::Mat1f(kHeight, kWidth, 90.0F))), 0.0, 1e-3);
  EXPECT_EQ(contrast(ImagePyramid()), 0.0);
}

}  // namespace
}  // namespace mba_vo::image_content_test
