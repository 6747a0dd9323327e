#include "mba_vo/odometry/image_intake.h"

#include <gtest/gtest.h>

namespace mba_vo {
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

}  // namespace
}  // namespace mba_vo
