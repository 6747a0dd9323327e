#include "mba_vo/image/binning.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "mba_vo/image/corrected_calibration.h"
#include "mba_vo/image/frame_builder.h"

namespace mba_vo::binning_test {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

CameraCalibration undistorted(int width, int height) {
  return {width, height, 100.0, 101.0, 63.0, 47.0, "plumb_bob", {0, 0, 0, 0, 0}};
}

FrameBuilderConfig configFor(int binning) {
  FrameBuilderConfig config;
  config.binning = binning;
  return config;
}

TEST(Binning, IsChosenForLargeImagesAndElseAsTold) {
  EXPECT_EQ(binningOf(0, undistorted(752, 480)), 1);
  EXPECT_EQ(binningOf(0, undistorted(960, 540)), 1);
  EXPECT_EQ(binningOf(0, undistorted(1280, 720)), 2);
  EXPECT_EQ(binningOf(1, undistorted(1280, 1024)), 1);
  EXPECT_EQ(binningOf(4, undistorted(752, 480)), 4);
}

TEST(Binning, APixelSeesWhatItsPixelsSeeInTheMean) {
  const std::vector<CameraCalibration> cameras = {
      {320, 240, 180.0, 182.0, 161.3, 118.2, "plumb_bob", {-0.28, 0.07, 2e-4, -3e-4, 0.0}},
      {320, 240, 180.0, 182.0, 161.3, 118.2, "equidistant", {0.01, -0.005, 0.002, -0.0005}},
      {320, 240, 180.0, 182.0, 161.3, 118.2, "fov", {0.93}}};
  const std::vector<cv::Point3d> rays = {{0.0, 0.0, 1.0}, {-0.7, 0.4, 1.0}, {0.5, -0.6, 1.0}};
  for (const CameraCalibration& camera : cameras) {
    for (const int binning : {1, 2, 3}) {
      const std::vector<cv::Point2d> fine = projectRays(camera, rays);
      const std::vector<cv::Point2d> coarse = projectRays(binned(camera, binning), rays);
      for (std::size_t i = 0; i < rays.size(); ++i) {  // pixel u is the mean of binning u to binning (u + 1) - 1
        EXPECT_NEAR(fine[i].x, binning * coarse[i].x + 0.5 * (binning - 1), 1e-9) << camera.distortion_model;
        EXPECT_NEAR(fine[i].y, binning * coarse[i].y + 0.5 * (binning - 1), 1e-9) << camera.distortion_model;
      }
    }
  }
}

TEST(Binning, IsTheMeanOfLightAndNotOfGreyValues) {
  cv::Mat1b image(96, 128, std::uint8_t{0});
  for (int x = 1; x < image.cols; x += 2) image.col(x) = 200;
  FrameBuilderConfig config = configFor(2);
  config.gamma = 2.2;
  const FrameConstPtr frame = FrameBuilder(undistorted(128, 96), {}, config).build(image, 0, 0, 0, 0.01);
  const ImageLevel& level = frame->pyramid.level(0);
  ASSERT_EQ(level.intensity.size(), cv::Size(64, 48));
  EXPECT_NEAR(level.intensity(20, 30), 0.5 * 255.0 * std::pow(200.0 / 255.0, 2.2), 0.01);
}

TEST(Binning, CameraAndRowTimeAreThoseOfTheBinnedRows) {
  FrameBuilderConfig config = configFor(2);
  config.row_time = 3e-5;
  FrameBuilder builder(undistorted(128, 96), {}, config);
  EXPECT_EQ(builder.camera().width, 64);
  EXPECT_DOUBLE_EQ(builder.camera().fx, 50.0);
  EXPECT_DOUBLE_EQ(builder.camera().cx, 31.25);
  EXPECT_DOUBLE_EQ(builder.camera().row_time, 6e-5);
  CalibrationCorrection correction;
  correction.values(CalibrationCorrection::kReadout) = 96 * 1e-5;
  builder.correct(correction);
  EXPECT_DOUBLE_EQ(builder.camera().row_time, 8e-5);
}

TEST(Binning, WhatIsUnknownIsUnknownInTheMean) {
  cv::Mat1f image(4, 7, 1.0F);  // the last column is left over
  image(1, 1) = kUnknown;
  const cv::Mat1f result = binned(image, 2);
  ASSERT_EQ(result.size(), cv::Size(3, 2));
  EXPECT_TRUE(std::isnan(result(0, 0)));
  for (const cv::Point at : {cv::Point(1, 0), cv::Point(2, 0), cv::Point(0, 1), cv::Point(1, 1)}) {
    EXPECT_EQ(result(at), 1.0F);
  }
}

TEST(Binning, MasksAndImagesHaveTheSizeOfTheCamera) {
  PhotometricCalibration photometric;
  photometric.mask = cv::Mat1b(96, 128, std::uint8_t{255});
  photometric.mask(cv::Rect(0, 0, 21, 96)) = 0;
  const FrameBuilder builder(undistorted(128, 96), photometric, configFor(2));
  const FrameConstPtr frame = builder.build(cv::Mat1b(96, 128, std::uint8_t{90}), 0, 0, 0, 0.01);
  const cv::Mat1f& intensity = frame->pyramid.level(0).intensity;
  EXPECT_TRUE(std::isnan(intensity(40, 10))) << "half of its pixels";
  EXPECT_EQ(intensity(40, 11), 90.0F);
  try {
    builder.build(cv::Mat1b(48, 64, std::uint8_t{90}), 0, 0, 0, 0.01);
    FAIL() << "taken for an image of the camera";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("128x96"), std::string::npos) << error.what();
  }
}

TEST(Binning, DepthsAreNotAveraged) {
  cv::Mat1f depth(4, 4, 1.0F);
  depth(cv::Rect(1, 0, 3, 4)) = 5.0F;
  const cv::Mat1f result = binnedDepth(depth, 2);
  for (const float z : result) EXPECT_TRUE(z == 1.0F || z == 5.0F) << z;
}

}  // namespace
}  // namespace mba_vo::binning_test
