#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/device_camera_fixture.h"

namespace mba_vo::exposure_control_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using ExposureControlTest = DeviceCameraTest;

TEST_F(ExposureControlTest, StaleReadingsOfAutomaticExposureAreNotBelieved) {
  const auto camera = open();
  EXPECT_EQ(device_->controls[V4L2_CID_EXPOSURE_AUTO].value, V4L2_EXPOSURE_APERTURE_PRIORITY);
  EXPECT_FALSE(play(*camera, 30)->exposure.has_value());
  device_->controls[V4L2_CID_EXPOSURE_ABSOLUTE].value = 80;  // this one tells the truth
  EXPECT_EQ(play(*camera, 30)->exposure, 0.008);
  device_->controls[V4L2_CID_EXPOSURE_ABSOLUTE].value = 500;  // longer than images are apart
  EXPECT_FALSE(play(*camera, 30)->exposure.has_value());
}

TEST_F(ExposureControlTest, AutomaticExposureIsCappedByTheRate) {
  open();
  EXPECT_EQ(device_->controls[V4L2_CID_EXPOSURE_AUTO_PRIORITY].value, 0);
  settings_.device.exposure.dynamic_frame_rate = true;
  open();
  EXPECT_EQ(device_->controls[V4L2_CID_EXPOSURE_AUTO_PRIORITY].value, 1);
}

TEST_F(ExposureControlTest, ExposureRegulatedUpToALimit) {
  device_->controls[V4L2_CID_GAIN] = {0, 100, 1, 50};
  settings_.device.exposure.longest = 0.008;
  const auto camera = open();
  std::optional<CapturedImage> image;
  const auto look_at = [&](double light) {
    constexpr int kImages = 200;
    double level = 0.0;
    for (int i = 0; i < kImages; ++i) {
      const double exposure = 1e-4 * device_->controls[V4L2_CID_EXPOSURE_ABSOLUTE].value;
      EXPECT_LE(exposure, 0.008);
      level = light * exposure * (1.0 + 0.1 * device_->controls[V4L2_CID_GAIN].value);
      clock_->sleepFor(kInterval);
      device_->sendGrey(cv::saturate_cast<unsigned char>(level), sequence_++);
      image = nextImage(*camera);
    }
    EXPECT_GT(level, 70.0);
    EXPECT_LT(level, 150.0);
    EXPECT_EQ(image->exposure, 1e-4 * device_->controls[V4L2_CID_EXPOSURE_ABSOLUTE].value);
  };
  look_at(1e5);
  EXPECT_LT(*image->exposure, 0.003);
  EXPECT_EQ(device_->controls[V4L2_CID_GAIN].value, 0);  // noise only where there is no other way
  look_at(2e3);
  EXPECT_EQ(image->exposure, 0.008);
  EXPECT_GT(device_->controls[V4L2_CID_GAIN].value, 0);
  look_at(1e5);
  EXPECT_EQ(device_->controls[V4L2_CID_GAIN].value, 0);
}

TEST_F(ExposureControlTest, ExposuresAreUnknownWhileAChangeIsOnItsWay) {
  settings_.device.exposure.longest = 0.008;
  const auto camera = open();
  EXPECT_FALSE(play(*camera, 1)->exposure.has_value());
  EXPECT_EQ(play(*camera, 30)->exposure, 0.008);
  device_->sendGrey(250, sequence_++);
  EXPECT_EQ(nextImage(*camera)->exposure, 0.008);
  EXPECT_FALSE(play(*camera, 1)->exposure.has_value());
  EXPECT_LT(play(*camera, 30)->exposure.value(), 0.005);
}

TEST_F(ExposureControlTest, ExposuresThatCannotBeAreNamed) {
  settings_.device.exposure.seconds = 0.00001;
  EXPECT_THAT(errorOnOpen(), AllOf(HasSubstr("1e-05 s"), HasSubstr("0.0003 s to 0.2047 s")));
  settings_.device.exposure.seconds = 0.05;
  auto camera = open();
  play(*camera, 1);
  EXPECT_THAT(told_, HasSubstr("50 ms is longer than images are apart (33.3333 ms)"));
  camera.reset();
  device_->controls[V4L2_CID_EXPOSURE_ABSOLUTE].stuck = true;
  device_->controls[V4L2_CID_EXPOSURE_ABSOLUTE].value = 250;
  settings_.device.exposure.seconds = 0.01;
  camera = open();
  EXPECT_EQ(play(*camera, 1)->exposure, 0.025);  // what it is, not what it should be
  EXPECT_THAT(told_, HasSubstr("asked for an exposure of 10 ms the camera says 25 ms"));
  settings_.device.exposure = {{}, 0.0001, false};
  EXPECT_THAT(errorOnOpen(), AllOf(HasSubstr("max_exposure is 0.0001 s"), HasSubstr("0.0003 s")));
  settings_.device.exposure.seconds = 0.01;
  device_->controls.erase(V4L2_CID_EXPOSURE_ABSOLUTE);
  EXPECT_THAT(errorOnOpen(), HasSubstr("exposure cannot be set"));
}

}  // namespace
}  // namespace mba_vo::exposure_control_test
