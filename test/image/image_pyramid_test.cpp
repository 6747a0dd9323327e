#include "mba_vo/image/image_pyramid.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

namespace mba_vo::image_pyramid_test {
namespace {

const PinholeCamera kCamera{96, 64, 100.0, 90.0, 47.5, 31.5};

/// Linear ramp: bilinear averaging of it is exact, so every level shows the same ramp at its own pixel centres.
double ramp(double x, double y) { return 10.0 + 0.5 * x + 0.25 * y; }

cv::Mat1f makeRamp() {
  cv::Mat1f image(kCamera.height, kCamera.width);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) image(y, x) = static_cast<float>(ramp(x, y));
  }
  return image;
}

TEST(ImagePyramid, EveryLevelShowsTheSameRay) {
  const ImagePyramid pyramid(makeRamp(), kCamera, 3);
  ASSERT_EQ(pyramid.levels(), 3);
  for (int l = 0; l < pyramid.levels(); ++l) {
    const ImageLevel& level = pyramid.level(l);
    ASSERT_EQ(level.intensity.cols, kCamera.width >> l);
    ASSERT_EQ(level.camera.height, kCamera.height >> l);
    for (int y = 0; y < level.intensity.rows; y += 5) {
      for (int x = 0; x < level.intensity.cols; x += 5) {
        const Eigen::Vector2d at_finest = kCamera.project(level.camera.unproject(Eigen::Vector2d(x, y)));
        EXPECT_NEAR(level.intensity(y, x), ramp(at_finest.x(), at_finest.y()), 1e-4) << "level " << l;
      }
    }
  }
}

TEST(ImagePyramid, EveryLevelGetsTheCorrectedCamera) {
  CalibrationCorrection lacking;
  lacking.values.head<6>() << 0.02, 0.01, -0.02, 0.0, 0.0, 1e-5 * kCamera.height;
  const ImagePyramid original(makeRamp(), kCamera, 3);
  ImagePyramid corrected = original;
  corrected.correctCamera(lacking);
  EXPECT_TRUE(corrected.showsTheSameAs(original));
  EXPECT_FALSE(corrected.showsTheSameAs(ImagePyramid(makeRamp(), kCamera, 3)));
  const PinholeCamera finest = corrected.level(0).camera;
  EXPECT_DOUBLE_EQ(finest.fx, 1.02 * kCamera.fx);
  for (int l = 0; l < corrected.levels(); ++l) {
    const PinholeCamera& camera = corrected.level(l).camera;
    const PinholeCamera& before = original.level(l).camera;
    EXPECT_NEAR(camera.rowDelay(0.0), finest.rowDelay(0.5 * (1 << l) - 0.5), 1e-12) << "level " << l;
    const Eigen::Vector2d pixel(3.0, 7.0);
    const Eigen::Vector2d at_finest = kCamera.project(before.unproject(pixel));
    EXPECT_LT((camera.unproject(pixel) - finest.unproject(at_finest)).norm(), 1e-9) << "level " << l;
  }
}

TEST(ImagePyramid, StopsBeforeLevelsBecomeTooSmall) {
  const ImagePyramid pyramid(makeRamp(), kCamera, 8);
  EXPECT_EQ(pyramid.levels(), 3);  // 96x64, 48x32, 24x16
  EXPECT_EQ(pyramid.bytes(), sizeof(float) * (96 * 64 + 48 * 32 + 24 * 16));
}

TEST(ImagePyramid, InvalidPixelsSpread) {
  cv::Mat1f image = makeRamp();
  image(33, 40) = std::numeric_limits<float>::quiet_NaN();
  const ImagePyramid pyramid(image, kCamera, 3);
  for (int l = 0; l < 3; ++l) {
    const cv::Mat1f& level = pyramid.level(l).intensity;
    for (int y = 0; y < level.rows; ++y) {
      for (int x = 0; x < level.cols; ++x) {
        EXPECT_EQ(std::isnan(level(y, x)), y == (33 >> l) && x == (40 >> l));
      }
    }
  }
}

TEST(ImagePyramid, RejectsSizesThatDisagree) {
  const cv::Mat1f small(32, 96, 0.0F);
  EXPECT_THROW(ImagePyramid(small, kCamera, 3), std::invalid_argument);
  EXPECT_THROW(ImagePyramid(makeRamp(), kCamera, 0), std::invalid_argument);
}

}  // namespace
}  // namespace mba_vo::image_pyramid_test
