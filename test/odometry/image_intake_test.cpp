#include "mba_vo/odometry/image_intake.h"

#include <chrono>
#include <cmath>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace mba_vo::image_intake_test {
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 48;

ImageIntake openIntake() {
  ImageIntake intake({}, {}, false);
  intake.setCalibration({kWidth, kHeight, 60.0, 60.0, 31.5, 23.5, "", {}}, {});
  return intake;
}

CameraImage imageOf(int number, const cv::Mat& pixels) {
  CameraImage image;
  image.sequence = static_cast<std::uint64_t>(number);
  image.stamp_ns = image.mid_exposure_ns = 30000000 * static_cast<std::int64_t>(number + 1);
  image.image = pixels;
  return image;
}

cv::Mat grey(int value) { return cv::Mat1b(kHeight, kWidth, static_cast<std::uint8_t>(value)); }

void expectLight(const ImageIntake::Result& result, float intensity, double gain) {
  ASSERT_TRUE(result.frame);
  const ImageLevel& level = result.frame->pyramid.level(0);
  EXPECT_EQ(level.intensity(20, 30), intensity);
  EXPECT_EQ(level.gain, gain);
}

TEST(ImageIntake, DarkScenesAreBrightenedUntilTheLightChanges) {
  ImageIntake intake = openIntake();
  expectLight(intake.take(imageOf(0, grey(20))), 80.0F, 4.0);
  expectLight(intake.take(imageOf(1, grey(30))), 120.0F, 4.0);
  expectLight(intake.take(imageOf(2, grey(150))), 150.0F, 1.0);
  expectLight(intake.take(imageOf(3, grey(30))), 30.0F, 1.0);
}

TEST(ImageIntake, ANewStartIsJudgedByItsOwnLight) {
  ImageIntake intake = openIntake();
  expectLight(intake.take(imageOf(0, grey(20))), 80.0F, 4.0);
  intake.reset();
  expectLight(intake.take(imageOf(0, grey(40))), 80.0F, 2.0);
}

TEST(ImageIntake, SaysThatWhiteIsElsewhere) {
  ImageIntake intake = openIntake();
  EXPECT_EQ(intake.take(imageOf(0, cv::Mat1w(kHeight, kWidth, std::uint16_t{800}))).reason, "");
  const ImageIntake::Result brighter = intake.take(imageOf(1, cv::Mat1w(kHeight, kWidth, std::uint16_t{2000})));
  EXPECT_NE(brighter.reason.find("white is 4095, not 1023"), std::string::npos) << brighter.reason;
  EXPECT_NEAR(brighter.frame->pyramid.level(0).intensity(20, 30), 255.0 * 2000.0 / 4095.0, 1e-3);
}

TEST(ImageIntake, HalvesImagesWhereItMayAndEnoughIsLeft) {
  const auto take = [](ImageIntake& from, int number) {
    const ImageIntake::Result result =
        from.take(imageOf(number, cv::Mat1b(480, 640, static_cast<std::uint8_t>(100 + number % 100))));
    return result.frame->pyramid.level(0).camera;
  };
  for (const bool in_background : {false, true}) {
    ImageIntake intake({}, {}, in_background);
    intake.setCalibration({640, 480, 400.0, 400.0, 319.5, 239.5, "", {}}, {});
    EXPECT_EQ(take(intake, 0).width, 640);
    EXPECT_NE(intake.halve().find("320x240"), std::string::npos);
    PinholeCamera camera = take(intake, 1);
    for (int i = 2; in_background && i < 1000 && camera.width == 640; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      camera = take(intake, i);
    }
    EXPECT_EQ(camera.width, 320);
    EXPECT_DOUBLE_EQ(camera.cx, 159.5);
    EXPECT_EQ(intake.halve(), "") << "160 columns are too few";
    intake.reset();
    EXPECT_EQ(take(intake, 0).width, 320) << "as slow as before";
  }
  FrameBuilderConfig told;
  told.binning = 1;
  ImageIntake intake(told, {}, false);
  intake.setCalibration({640, 480, 400.0, 400.0, 319.5, 239.5, "", {}}, {});
  EXPECT_EQ(intake.halve(), "");
}

/// What a camera sees that moves past textures, with a cross burnt in.
class WatermarkedStream {
 public:
  static constexpr int kSide = 200;  // [px]

  WatermarkedStream() : world_(3 * kSide, 3 * kSide) {
    cv::RNG(1).fill(world_, cv::RNG::NORMAL, 0.0, 300.0);
    cv::GaussianBlur(world_, world_, {}, 2.5);
    world_ += 110.0F;
  }
  CameraImage image(int number) const {
    const cv::Rect seen(kSide + static_cast<int>(150.0 * std::sin(0.031 * number)),
                        kSide + static_cast<int>(150.0 * std::sin(0.023 * number + 1.0)), kSide, kSide);
    cv::Mat1b pixels;
    world_(seen).convertTo(pixels, CV_8U);
    pixels(cv::Rect(50, 20, 20, 3)).setTo(240);
    pixels(cv::Rect(58, 10, 3, 20)).setTo(240);
    return imageOf(number, pixels);
  }
  static ImageIntake openIntake(const FrameBuilderConfig& config, const PhotometricCalibration& photometric = {}) {
    ImageIntake intake(config, photometric, false);
    intake.setCalibration({kSide, kSide, 200.0, 200.0, 99.5, 99.5, "", {}}, {});
    return intake;
  }

 private:
  cv::Mat1f world_;
};

TEST(ImageIntake, WhatCoversTheSceneIsMaskedAndToldOnce) {
  const WatermarkedStream stream;
  for (const bool find : {true, false}) {
    FrameBuilderConfig config;
    config.find_overlay = find;
    ImageIntake intake = WatermarkedStream::openIntake(config);
    int told = 0;
    FrameConstPtr last;
    for (int i = 0; i < 180; ++i) {
      const ImageIntake::Result result = intake.take(stream.image(i));
      if (result.reason.find("static overlay: ") != std::string::npos) ++told;
      if (result.frame) last = result.frame;
    }
    EXPECT_EQ(told, find ? 1 : 0);
    EXPECT_EQ(std::isnan(last->pyramid.level(0).intensity(20, 59)), find);
    EXPECT_EQ(last->overlay.empty(), !find);
    EXPECT_FALSE(std::isnan(last->pyramid.level(0).intensity(100, 100)));
    intake.reset();
    EXPECT_FALSE(std::isnan(intake.take(stream.image(1)).frame->pyramid.level(0).intensity(20, 59))) << "as if new";
  }
}

TEST(ImageIntake, AMaskIsNotLookedAtWhereImagesAreCompared) {
  const WatermarkedStream stream;
  PhotometricCalibration photometric;
  photometric.mask = cv::Mat1b(WatermarkedStream::kSide, WatermarkedStream::kSide, std::uint8_t{255});
  photometric.mask(cv::Rect(0, 0, 50, 50)).setTo(0);
  ImageIntake intake = WatermarkedStream::openIntake({}, photometric);
  CameraImage image = stream.image(0);
  EXPECT_TRUE(intake.take(image).frame);
  CameraImage again = stream.image(0);
  again.image(cv::Rect(10, 10, 20, 10)).setTo(0);  // a clock
  again.stamp_ns = again.mid_exposure_ns = image.stamp_ns + 30000000;
  EXPECT_TRUE(intake.take(again).repeats);
}

}  // namespace
}  // namespace mba_vo::image_intake_test
