#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "capture/device_camera_fixture.h"

namespace mba_vo::device_camera_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST_F(DeviceCameraTest, ImagesComeWithNumbersAndStamps) {
  settings_.device.exposure.seconds = 0.01;
  const auto camera = open();
  const auto image = play(*camera, 3);
  ASSERT_TRUE(image.has_value());
  EXPECT_EQ(image->image.size(), cv::Size(640, 480));
  EXPECT_EQ(image->image.type(), CV_8UC1);
  EXPECT_EQ(image->number, 3U);
  EXPECT_EQ(image->exposure, 0.01);
  EXPECT_EQ(image->mid_exposure_ns, clock_->wallNow() + 5'000'000);  // stamped when the exposure began
  EXPECT_THAT(told_, AllOf(HasSubstr("Fake Webcam"), HasSubstr("yuyv 640x480 at 30 Hz"), HasSubstr("exposure 10 ms"),
                           HasSubstr("start of exposure, monotonic clock")));
}

TEST_F(DeviceCameraTest, WhatIsAskedForIsSet) {
  settings_.device.path = "0";  // short for /dev/video0
  settings_.device.format = {"mjpeg", 1280, 720, 30.0};
  settings_.device.exposure.seconds = 0.02;
  const auto camera = open();
  EXPECT_EQ(device_->format.pixelformat, static_cast<std::uint32_t>(V4L2_PIX_FMT_MJPEG));
  EXPECT_EQ(device_->format.width, 1280U);
  EXPECT_EQ(device_->rate, 30U);
  EXPECT_EQ(device_->controls[V4L2_CID_EXPOSURE_AUTO].value, V4L2_EXPOSURE_MANUAL);
  EXPECT_EQ(device_->controls[V4L2_CID_EXPOSURE_ABSOLUTE].value, 200);
}

TEST_F(DeviceCameraTest, JpegAndColour) {
  settings_.device.format.pixel_format = "mjpeg";
  settings_.device.color = true;
  const auto camera = open();
  FakeDevice::Image jpeg;
  cv::imencode(".jpg", cv::Mat(480, 640, CV_8UC3, cv::Scalar(20, 90, 200)), jpeg.bytes);
  jpeg.bytes.resize(jpeg.bytes.size() + 7);  // cameras pad
  jpeg.stamp_ns = clock_->monotonicNow();
  device_->send(jpeg);
  const auto image = nextImage(*camera);
  ASSERT_TRUE(image.has_value());
  ASSERT_EQ(image->image.type(), CV_8UC3);
  EXPECT_NEAR(image->image.at<cv::Vec3b>(100, 100)[2], 200, 3);
}

TEST_F(DeviceCameraTest, DamagedImagesAreLeftOutAndCounted) {
  settings_.device.format.pixel_format = "mjpeg";
  const auto camera = open();
  FakeDevice::Image good;
  cv::imencode(".jpg", cv::Mat(480, 640, CV_8UC1, cv::Scalar(90)), good.bytes);
  good.stamp_ns = clock_->monotonicNow();
  FakeDevice::Image half = good, flagged = good, other_size = good;
  half.bytes.resize(half.bytes.size() / 2);
  flagged.flags |= V4L2_BUF_FLAG_ERROR;
  cv::imencode(".jpg", cv::Mat(48, 64, CV_8UC1, cv::Scalar(90)), other_size.bytes);
  const std::vector<std::pair<FakeDevice::Image, std::string>> damaged = {
      {half, "cut off"}, {flagged, "data are missing"}, {other_size, "64x48"}};
  for (const auto& [image, reason] : damaged) {
    clock_->sleepFor(6'000'000'000);  // it is told every few seconds
    for (FakeDevice::Image next : {image, good}) {
      next.stamp_ns = clock_->monotonicNow();
      next.sequence = sequence_++;
      device_->send(next);
    }
    EXPECT_EQ(nextImage(*camera)->number, sequence_) << reason;
    EXPECT_THAT(told_, HasSubstr(reason));
  }
  EXPECT_THAT(told_, HasSubstr("3 damaged images"));
}

TEST_F(DeviceCameraTest, HalfAnUncompressedImageIsNone) {
  const auto camera = open();
  device_->send({std::vector<unsigned char>(1000), clock_->monotonicNow(), 0});
  device_->sendGrey(100, 1);
  EXPECT_EQ(nextImage(*camera)->number, 2U);
  EXPECT_THAT(told_, HasSubstr("1000 of 614400 bytes"));
}

TEST_F(DeviceCameraTest, ImagesThatTheDriverDroppedAreGapsInTheNumbers) {
  const auto camera = open();
  play(*camera, 2);
  sequence_ += 3;
  EXPECT_EQ(play(*camera, 1)->number, 6U);
}

TEST_F(DeviceCameraTest, WhatKeepsItFromOpeningIsNamed) {
  settings_.device.path = "/dev/video7";
  EXPECT_THAT(errorOnOpen(), AllOf(HasSubstr("/dev/video7: no such device"), HasSubstr("/dev/video0")));
  settings_.device.path = "/dev/video1";
  EXPECT_THAT(errorOnOpen(),
              AllOf(HasSubstr("/dev/video1 (Fake Webcam): this device gives no images"), HasSubstr("/dev/video0")));
  settings_.device.path = "/dev/video0";
  device_->open_error = EACCES;
  EXPECT_THAT(errorOnOpen(), AllOf(HasSubstr("no permission"), HasSubstr("usermod -aG video")));
  device_->open_error = EBUSY;
  EXPECT_THAT(errorOnOpen(), HasSubstr("another program uses it"));
  device_->open_error = EMFILE;
  EXPECT_THAT(errorOnOpen(), HasSubstr("Too many open files"));
  device_->open_error = 0;
  device_->busy_error = EBUSY;
  EXPECT_THAT(errorOnOpen(), HasSubstr("another program uses it"));
  device_->busy_error = ENOSPC;
  EXPECT_THAT(errorOnOpen(), HasSubstr("bandwidth"));
  EXPECT_EQ(device_->opened, 0);  // closed again, each time
  settings_.device.path = "/dev/null";
  EXPECT_THAT(messageOf([this] { openCamera(settings_, kernelCalls(), clock_); }),
              HasSubstr("/dev/null: this is no video device"));
}

TEST_F(DeviceCameraTest, FormatsThatItHasNotAreNamed) {
  settings_.device.format = {"yuyv", 1280, 720, 30.0};
  EXPECT_THAT(errorOnOpen(), AllOf(HasSubstr("/dev/video0 (Fake Webcam): it has no rate of 30 Hz"),
                                   HasSubstr("yuyv 1280x720: 10 Hz")));
  settings_.device.format = {};
  device_->takes_height = 360;  // offers what it does not do
  EXPECT_THAT(errorOnOpen(), HasSubstr("asked for yuyv 640x480 at 30 Hz it takes yuyv 640x360"));
  device_->takes_height = 0;
  device_->takes_rate = 25;
  settings_.device.format.rate = 30.0;
  play(*open(), 1);
  EXPECT_THAT(told_, HasSubstr("asked for 30 Hz the camera takes 25 Hz"));
}

TEST_F(DeviceCameraTest, FocusThatMovesIsTold) {
  device_->controls[V4L2_CID_FOCUS_AUTO] = {0, 1, 1, 0};
  play(*open(), 1);
  EXPECT_THAT(told_, Not(HasSubstr("focus")));
  device_->controls[V4L2_CID_FOCUS_AUTO].value = 1;
  play(*open(), 1);
  EXPECT_THAT(told_, HasSubstr("focus_automatic_continuous=0"));
}

TEST_F(DeviceCameraTest, SizesInSteps) {
  device_->sizes_in_steps = true;
  device_->formats = {{V4L2_PIX_FMT_GREY, {{160, 120, {}}, {1920, 1080, {}}}}};
  settings_.device.format = {"auto", 808, 600, 50.0};
  open();
  EXPECT_EQ(device_->format.width, 808U);
  EXPECT_EQ(device_->rate, 50U);
}

TEST_F(DeviceCameraTest, DevicesAndTheirFormatsAreListed) {
  const std::string list = listDevices(device_);
  EXPECT_THAT(list, AllOf(HasSubstr("/dev/video0 (Fake Webcam)\n"), HasSubstr("yuyv 640x480: 30, 15 Hz")));
  device_->unplug();
  EXPECT_THAT(listDevices(device_), HasSubstr("no video device"));
}

TEST_F(DeviceCameraTest, UnpluggedAndPluggedInAgain) {
  settings_.device.exposure.seconds = 0.01;
  const auto camera = open();
  play(*camera, 5);
  device_->unplug();
  EXPECT_FALSE(nextImage(*camera).has_value());
  EXPECT_THAT(told_, AllOf(HasSubstr("LOST /dev/video0: it was unplugged"), Not(HasSubstr("FOUND"))));
  EXPECT_EQ(device_->opened, 0);                               // or it would come back under another name
  EXPECT_EQ(std::count(told_.begin(), told_.end(), '\n'), 3);  // what it is, LOST, and once why it is not there
  device_->plugIn();
  device_->open_error = EACCES;  // for a moment, until udev has been at it
  device_->controls[V4L2_CID_EXPOSURE_ABSOLUTE].value = 3;
  EXPECT_FALSE(nextImage(*camera).has_value());
  device_->open_error = 0;
  while (!device_->streaming) nextImage(*camera);
  sequence_ = 0;
  const auto image = play(*camera, 1);
  EXPECT_THAT(told_, HasSubstr("FOUND"));
  EXPECT_EQ(image->number, 6U);
  EXPECT_EQ(image->exposure, 0.01);  // set anew
}

TEST_F(DeviceCameraTest, ACameraThatFallsSilentIsOpenedAgain) {
  const auto camera = open();
  play(*camera, 1);
  EXPECT_FALSE(nextImage(*camera).has_value());
  EXPECT_THAT(told_, AllOf(HasSubstr("LOST /dev/video0: no image for"), HasSubstr("FOUND")));
  EXPECT_EQ(device_->opened, 1);
}

}  // namespace
}  // namespace mba_vo::device_camera_test
