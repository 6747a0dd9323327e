#include "mba_vo/image/frame_builder.h"

#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

namespace mba_vo::frame_builder_test {
namespace {

CameraCalibration undistorted() { return {128, 96, 100.0, 101.0, 63.0, 47.0, "plumb_bob", {0, 0, 0, 0, 0}}; }

cv::Mat1b noiseImage() {
  cv::Mat1b image(96, 128);
  cv::RNG rng(7);
  rng.fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}

std::string messageOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(FrameBuilder, UndistortedLinearImagePassesBitExact) {
  const FrameBuilder builder(undistorted(), {}, {});
  const cv::Mat1b image = noiseImage();
  const FrameConstPtr frame = builder.build(image, 12, 1000, 2000, 0.02);
  EXPECT_EQ(frame->sequence, 12U);
  EXPECT_EQ(frame->stamp_ns, 1000);
  EXPECT_EQ(frame->mid_exposure_ns, 2000);
  EXPECT_EQ(frame->exposure, 0.02);
  EXPECT_EQ(builder.camera().fy, 101.0);
  const ImageLevel& level = frame->pyramid.level(0);
  EXPECT_EQ(level.camera.cx, 63.0);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) ASSERT_EQ(level.intensity(y, x), static_cast<float>(image(y, x)));
  }
}

TEST(FrameBuilder, UnknownExposureStaysUnknown) {
  EXPECT_FALSE(FrameBuilder(undistorted(), {}, {}).build(noiseImage(), 0, 0, 0, std::nullopt)->exposure.has_value());
}

TEST(FrameBuilder, GreyWhateverTheEncoding) {
  const FrameBuilder builder(undistorted(), {}, {});
  const cv::Mat1b grey = noiseImage();
  cv::Mat colour;
  cv::merge(std::vector<cv::Mat>{grey, grey, grey}, colour);
  cv::Mat deep;
  grey.convertTo(deep, CV_16U, 257.0);
  for (const cv::Mat& image : {colour, deep}) {
    const FrameConstPtr frame = builder.build(image, 0, 0, 0, 0.0);
    for (int i = 0; i < 96; ++i) {
      EXPECT_NEAR(frame->pyramid.level(0).intensity(i, i), static_cast<float>(grey(i, i)), 1e-3F);
    }
  }
}

TEST(FrameBuilder, SixteenBitImagesAreWhiteWhereTold) {
  FrameBuilder builder(undistorted(), {}, {});
  builder.setWhiteLevel(4080.0);
  cv::Mat deep;
  noiseImage().convertTo(deep, CV_16U, 16.0);
  const FrameConstPtr frame = builder.build(deep, 0, 0, 0, 0.0);
  for (int i = 0; i < 96; ++i) {
    EXPECT_NEAR(frame->pyramid.level(0).intensity(i, i), static_cast<float>(noiseImage()(i, i)), 1e-3F);
  }
}

TEST(FrameBuilder, OverexposedImagesKeepWhatIsNotSaturated) {
  cv::Mat1b image(96, 128, std::uint8_t{100});
  image(cv::Rect(0, 0, 40, 40)).setTo(255);
  const ImagePyramid pyramid = FrameBuilder(undistorted(), {}, {}).build(image, 0, 0, 0, 0.0)->pyramid;
  EXPECT_TRUE(std::isnan(pyramid.level(0).intensity(39, 39)));
  EXPECT_EQ(pyramid.level(0).intensity(40, 40), 100.0F);
  EXPECT_EQ(pyramid.level(1).intensity(10, 10), 255.0F);
}

TEST(FrameBuilder, MaskedPixelsAreNotUsed) {
  PhotometricCalibration photometric;
  photometric.mask = cv::Mat1b(96, 128, std::uint8_t{255});
  photometric.mask(40, 50) = 0;
  const cv::Mat1b image = noiseImage();
  const ImagePyramid pyramid = FrameBuilder(undistorted(), photometric, {}).build(image, 0, 0, 0, 0.0)->pyramid;
  EXPECT_TRUE(std::isnan(pyramid.level(0).intensity(40, 50)));
  EXPECT_EQ(pyramid.level(0).intensity(40, 51), static_cast<float>(image(40, 51)));
  EXPECT_TRUE(std::isnan(pyramid.level(1).intensity(20, 25)));
  EXPECT_FALSE(std::isnan(pyramid.level(1).intensity(20, 26)));
}

TEST(FrameBuilder, NorAreRectifiedPixelsBetweenThem) {
  CameraCalibration distorted = undistorted();
  distorted.distortion = {-0.3, 0.1, 0.0, 0.0, 0.0};
  PhotometricCalibration photometric;
  photometric.mask = cv::Mat1b(96, 128, std::uint8_t{255});
  photometric.mask(20, 30) = 0;
  const cv::Mat1b dark(96, 128, std::uint8_t{100});
  cv::Mat1b bright_there = dark.clone();
  bright_there(20, 30) = 200;
  const FrameConstPtr seen = FrameBuilder(distorted, {}, {}).build(bright_there, 0, 0, 0, 0.0);
  const FrameConstPtr masked = FrameBuilder(distorted, photometric, {}).build(bright_there, 0, 0, 0, 0.0);
  int touched = 0;
  for (int y = 0; y < 96; ++y) {
    for (int x = 0; x < 128; ++x) {
      if (!(seen->pyramid.level(0).intensity(y, x) > 100.0F)) continue;
      ++touched;
      EXPECT_TRUE(std::isnan(masked->pyramid.level(0).intensity(y, x))) << x << ", " << y;
    }
  }
  EXPECT_GE(touched, 1);
  EXPECT_EQ(masked->pyramid.level(0).intensity(60, 60), 100.0F);
}

TEST(FrameBuilder, SaysWhereALargePartIsMasked) {
  PhotometricCalibration photometric;
  for (const int rows : {1, 20}) {
    photometric.mask = cv::Mat1b(96, 128, std::uint8_t{255});
    photometric.mask.rowRange(0, rows).setTo(0);
    EXPECT_EQ(FrameBuilder(undistorted(), photometric, {}).build(noiseImage(), 0, 0, 0, 0.0)->masked, rows == 20);
  }
}

TEST(FrameBuilder, AMaskOfAnotherSizeIsNamed) {
  FrameBuilderConfig config;
  config.mask_file = "bumper.png";
  PhotometricCalibration photometric;
  photometric.mask = cv::Mat1b(48, 64, std::uint8_t{255});
  EXPECT_EQ(messageOf([&] { FrameBuilder(undistorted(), photometric, config); }),
            "bumper.png: the mask is 64x48, the camera calibration says 128x96");
}

TEST(FrameBuilder, AnOverlayIsMaskedWithTheRest) {
  PhotometricCalibration photometric;
  photometric.mask = cv::Mat1b(96, 128, std::uint8_t{255});
  photometric.mask(40, 50) = 0;
  FrameBuilder builder(undistorted(), photometric, {});
  cv::Mat1b overlay(96, 128, std::uint8_t{0});
  overlay(10, 20) = 255;
  builder.setOverlay(overlay);
  const FrameConstPtr frame = builder.build(noiseImage(), 0, 0, 0, 0.0);
  EXPECT_EQ(frame->overlay.data, overlay.data);
  EXPECT_TRUE(std::isnan(frame->pyramid.level(0).intensity(40, 50)));
  EXPECT_TRUE(std::isnan(frame->pyramid.level(0).intensity(10, 20)));
  EXPECT_EQ(cv::countNonZero(builder.unused()), 2);
  builder.setOverlay({});
  EXPECT_EQ(cv::countNonZero(builder.unused()), 1);
}

TEST(FrameBuilder, AWhiteBumperDoesNotMakeAnImageOverexposed) {
  cv::Mat1b image(96, 128, std::uint8_t{100});
  const cv::Rect bumper(0, 0, 40, 40);
  image(bumper).setTo(255);
  image(90, 90) = 255;
  PhotometricCalibration photometric;
  photometric.mask = cv::Mat1b(96, 128, std::uint8_t{255});
  photometric.mask(bumper).setTo(0);
  const FrameConstPtr frame = FrameBuilder(undistorted(), photometric, {}).build(image, 0, 0, 0, 0.0);
  EXPECT_EQ(frame->pyramid.level(0).intensity(90, 90), 255.0F);
}

TEST(FrameBuilder, LampsStayAsTheyAre) {
  cv::Mat1b image(96, 128, std::uint8_t{100});
  image(cv::Rect(0, 0, 10, 10)).setTo(255);
  const FrameConstPtr frame = FrameBuilder(undistorted(), {}, {}).build(image, 0, 0, 0, 0.0);
  EXPECT_EQ(frame->pyramid.level(0).intensity(5, 5), 255.0F);
}

TEST(FrameBuilder, TheGainMultipliesTheLight) {
  FrameBuilder builder(undistorted(), {}, {});
  builder.setGain(4.0);
  const ImagePyramid pyramid = builder.build(cv::Mat1b(96, 128, std::uint8_t{20}), 0, 0, 0, 0.0)->pyramid;
  EXPECT_EQ(pyramid.level(0).intensity(5, 5), 80.0F);
  EXPECT_EQ(pyramid.level(pyramid.levels() - 1).gain, 4.0);
}

TEST(FrameBuilder, FramesDoNotShareTheInputsMemory) {
  const FrameBuilder builder(undistorted(), {}, {});
  cv::Mat1b image = noiseImage();
  const FrameConstPtr frame = builder.build(image, 0, 0, 0, 0.0);
  const float before = frame->pyramid.level(0).intensity(5, 5);
  image.setTo(0);
  EXPECT_EQ(frame->pyramid.level(0).intensity(5, 5), before);
}

TEST(FrameBuilder, TheVignetteOfTheCorrectionIsUndone) {
  FrameBuilder builder(undistorted(), {}, {});
  CalibrationCorrection correction;
  correction.values.tail<3>() << -0.3, -0.05, -0.02;
  cv::Mat1w image(96, 128);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const double log_light = correction.vignette().dot(vignetteJacobian(builder.camera(), {x, y}));
      image(y, x) = cv::saturate_cast<std::uint16_t>(257.0 * 120.0 * std::exp(log_light));
    }
  }
  builder.correct(correction);
  const FrameConstPtr frame = builder.build(image, 0, 0, 0, 0.0);
  EXPECT_EQ(frame->correction, correction);
  for (int i = 0; i < 96; ++i) EXPECT_NEAR(frame->pyramid.level(0).intensity(i, i), 120.0F, 0.01F) << i;
}

TEST(FrameBuilder, DepthIsRectifiedWithTheImage) {
  CameraCalibration distorted = undistorted();
  distorted.distortion = {-0.3, 0.1, 0.0, 0.0, 0.0};
  cv::Mat1f depth(96, 128, 2.0F);
  depth(cv::Rect(0, 0, 64, 96)).setTo(1.0F);
  const FrameBuilder builder(distorted, {}, {});
  EXPECT_TRUE(builder.build(noiseImage(), 0, 0, 0, 0.0)->depth.empty());
  const FrameConstPtr frame = builder.build(noiseImage(), 0, 0, 0, 0.0, depth);
  ASSERT_EQ(frame->depth.size(), cv::Size(128, 96));
  // The edge is at x = 63.5 and the distortion leaves the centre, 63, where it is. Nothing lies between the two sides.
  for (int x = 0; x < 128; ++x) EXPECT_EQ(frame->depth(47, x), x <= 63 ? 1.0F : 2.0F) << x;
  EXPECT_EQ(FrameBuilder(undistorted(), {}, {}).build(noiseImage(), 0, 0, 0, 0.0, depth)->depth(3, 64), 2.0F);
  const std::string message = messageOf([&] { builder.build(noiseImage(), 0, 0, 0, 0.0, cv::Mat1f(48, 64, 1.0F)); });
  EXPECT_NE(message.find("depth image is 64x48"), std::string::npos) << message;
}

TEST(FrameBuilder, ImageOfAnotherSizeNamesBothSizes) {
  const FrameBuilder builder(undistorted(), {}, {});
  const std::string message = messageOf([&] { builder.build(cv::Mat1b(48, 64), 0, 0, 0, 0.0); });
  EXPECT_NE(message.find("64x48"), std::string::npos) << message;
  EXPECT_NE(message.find("128x96"), std::string::npos) << message;
  EXPECT_NE(messageOf([&] { builder.build(cv::Mat(), 0, 0, 0, 0.0); }), "");
}

TEST(FrameBuilder, ImpossibleCalibrationNamesWhatIsWrong) {
  struct Case {
    std::function<void(CameraCalibration&)> spoil;
    std::vector<std::string> expected;
  };
  const std::vector<Case> cases{
      {[](CameraCalibration& c) { c.width = 0; }, {"width", "0"}},
      {[](CameraCalibration& c) { c.height = -5; }, {"height", "-5"}},
      {[](CameraCalibration& c) { c.fx = -1.0; }, {"fx", "-1"}},
      {[](CameraCalibration& c) { c.fy = 0.0; }, {"fy", "0"}},
      {[](CameraCalibration& c) { c.cx = std::nan(""); }, {"cx", "nan"}},
      {[](CameraCalibration& c) { c.distortion_model = "kannala"; }, {"kannala", "equidistant", "plumb_bob"}},
      {[](CameraCalibration& c) {
         c.distortion = {0.1, 0.2, 0.3};
       },
       {"plumb_bob", "3", "4 or 5"}},
      {[](CameraCalibration& c) { c.distortion_model = "rational_polynomial"; }, {"rational_polynomial", "5", "8"}},
      {[](CameraCalibration& c) { c.distortion_model = "fov"; }, {"fov", "5", "1"}},
      {[](CameraCalibration& c) {
         c.distortion_model = "fov";
         c.distortion = {3.2};
       },
       {"omega", "3.2", "pi"}},
      {[](CameraCalibration& c) { c.distortion_model = "equidistant"; }, {"equidistant", "5", "4"}},
      {[](CameraCalibration& c) { c.distortion[1] = INFINITY; }, {"coefficient", "inf"}},
      {[](CameraCalibration& c) {
         c.distortion_model = "";
         c.distortion[0] = 0.1;
       },
       {"distortion model", "empty"}}};
  for (const Case& test : cases) {
    CameraCalibration calibration = undistorted();
    test.spoil(calibration);
    const std::string message = messageOf([&] { FrameBuilder(calibration, {}, {}); });
    for (const std::string& word : test.expected) EXPECT_NE(message.find(word), std::string::npos) << message;
  }
}

TEST(FrameBuilder, ImpossibleConfigurationIsRejected) {
  FrameBuilderConfig config;
  config.pyramid_levels = 0;
  EXPECT_NE(messageOf([&] { FrameBuilder(undistorted(), {}, config); }).find("pyramid_levels"), std::string::npos);
  config = {};
  config.gamma = -1.0;
  EXPECT_NE(messageOf([&] { FrameBuilder(undistorted(), {}, config); }).find("gamma"), std::string::npos);
}

TEST(FrameBuilder, ACorrectionHoldsFromTheNextImageOn) {
  FrameBuilderConfig config;
  config.row_time = 2e-5;
  FrameBuilder builder({64, 48, 60.0, 60.0, 31.5, 23.5, "plumb_bob", {}}, {}, config);
  const cv::Mat1b image(48, 64, static_cast<unsigned char>(50));
  CalibrationCorrection correction;
  correction.values(CalibrationCorrection::kReadout) = 48 * 1e-5;
  const FrameConstPtr before = builder.build(image, 0, 0, 0, 0.0);
  builder.correct(correction);
  const FrameConstPtr after = builder.build(image, 1, 1, 1, 0.0);
  EXPECT_TRUE(before->correction.isZero());
  EXPECT_EQ(before->pyramid.level(0).camera.row_time, 2e-5);
  EXPECT_EQ(after->correction, correction);
  EXPECT_NEAR(after->pyramid.level(0).camera.row_time, 3e-5, 1e-12);
}

}  // namespace
}  // namespace mba_vo::frame_builder_test
