#include "mba_vo/ros/conversions.h"

#include <gtest/gtest.h>
#include <boost/make_shared.hpp>

#include "mba_vo/ros/camera_info.h"
#include "mba_vo/ros/exposure_lookup.h"
#include "mba_vo/ros/image_conversion.h"

namespace mba_vo::conversions_test {
namespace {

sensor_msgs::CameraInfo testCameraInfo() {
  sensor_msgs::CameraInfo info;
  info.width = 640;
  info.height = 480;
  info.distortion_model = "plumb_bob";
  info.D = {0.1, 0.0, 0.0, 0.0, 0.0};
  info.K = {400.0, 0.0, 319.5, 0.0, 410.0, 239.5, 0.0, 0.0, 1.0};
  info.P = {380.0, 0.0, 310.0, 0.0, 0.0, 381.0, 230.0, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

std::string errorOf(const sensor_msgs::CameraInfo& info) {
  try {
    calibrationFromCameraInfo(info);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Conversions, OpticalAxesInBodyAxes) {
  const SE3 T = T_body_optical();
  EXPECT_TRUE((T * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d::UnitX()));   // forward
  EXPECT_TRUE((T * Eigen::Vector3d::UnitX()).isApprox(-Eigen::Vector3d::UnitY()));  // right
  EXPECT_TRUE((T * Eigen::Vector3d::UnitY()).isApprox(-Eigen::Vector3d::UnitZ()));  // down
}

TEST(Conversions, CameraGoingForwardIsBaseGoingForward) {
  const SE3 forward(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.0, 0.0, 2.0));
  const SE3 base = toBaseWorld(forward, T_body_optical());
  EXPECT_TRUE(base.translation().isApprox(Eigen::Vector3d(2.0, 0.0, 0.0)));
  EXPECT_NEAR(base.rotation().angularDistance(Eigen::Quaterniond::Identity()), 0.0, 1e-12);
}

TEST(Conversions, BaseTurnsAboutItsOwnOrigin) {
  // A camera 1 m ahead of the base; the base turns left by 90 degrees: the camera moves 1 m to the left and back.
  const SE3 T_base_camera(T_body_optical().rotation(), Eigen::Vector3d(1.0, 0.0, 0.0));
  const SE3 turn(Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitZ())), Eigen::Vector3d::Zero());
  const SE3 T_camera0_camera = T_base_camera.inverse() * turn * T_base_camera;
  const SE3 base = toBaseWorld(T_camera0_camera, T_base_camera);
  EXPECT_NEAR(base.translation().norm(), 0.0, 1e-12);
  EXPECT_NEAR(base.rotation().angularDistance(turn.rotation()), 0.0, 1e-7);
}

TEST(Conversions, TimesAreExact) {
  EXPECT_EQ(toNanoseconds(toRosTime(1'305'031'453'359'684'123)), 1'305'031'453'359'684'123);
}

TEST(Conversions, MidExposureFollowsTheStampReference) {
  EXPECT_EQ(midExposure(1'000'000'000, 0.02, StampReference::kStart), 1'010'000'000);
  EXPECT_EQ(midExposure(1'000'000'000, 0.02, StampReference::kMiddle), 1'000'000'000);
  EXPECT_EQ(midExposure(1'000'000'000, 0.02, StampReference::kEnd), 990'000'000);
  EXPECT_EQ(midExposure(1'000'000'000, std::nullopt, StampReference::kEnd), 1'000'000'000);
}

TEST(Conversions, UnknownStampReferenceIsNamed) {
  EXPECT_EQ(parseStampReference("end"), StampReference::kEnd);
  try {
    parseStampReference("centre");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("'centre'; allowed: start, middle, end"), std::string::npos);
  }
}

TEST(CameraInfo, FullResolution) {
  const CameraCalibration calibration = calibrationFromCameraInfo(testCameraInfo());
  EXPECT_EQ(calibration.width, 640);
  EXPECT_DOUBLE_EQ(calibration.fy, 410.0);
  EXPECT_DOUBLE_EQ(calibration.cx, 319.5);
  EXPECT_EQ(calibration.distortion_model, "plumb_bob");
  EXPECT_EQ(calibration.distortion.size(), 5U);
}

TEST(CameraInfo, BinningAndRegionKeepTheRayOfAPixel) {
  sensor_msgs::CameraInfo info = testCameraInfo();
  info.binning_x = 2;
  info.binning_y = 4;
  info.roi.x_offset = 100;
  info.roi.y_offset = 40;
  info.roi.width = 400;
  info.roi.height = 320;
  const CameraCalibration calibration = calibrationFromCameraInfo(info);
  EXPECT_EQ(calibration.width, 200);
  EXPECT_EQ(calibration.height, 80);
  // Binned pixel (7, 3) averages the full-resolution pixels 100 + {14, 15} and 40 + {12 .. 15}.
  const double x = (100.0 + 14.5 - 319.5) / 400.0;
  const double y = (40.0 + 13.5 - 239.5) / 410.0;
  EXPECT_NEAR((7.0 - calibration.cx) / calibration.fx, x, 1e-12);
  EXPECT_NEAR((3.0 - calibration.cy) / calibration.fy, y, 1e-12);
}

TEST(CameraInfo, RectifiedImagesUseP) {
  const CameraCalibration calibration = calibrationFromCameraInfo(testCameraInfo(), true);
  EXPECT_DOUBLE_EQ(calibration.fx, 380.0);
  EXPECT_DOUBLE_EQ(calibration.cy, 230.0);
  EXPECT_TRUE(calibration.distortion.empty());
}

TEST(CameraInfo, ImpossibleValuesAreNamed) {
  sensor_msgs::CameraInfo info = testCameraInfo();
  info.K[0] = 0.0;
  EXPECT_NE(errorOf(info).find("K[0] is 0"), std::string::npos) << errorOf(info);
  info = testCameraInfo();
  info.width = 0;
  EXPECT_NE(errorOf(info).find("0x480"), std::string::npos) << errorOf(info);
  info = testCameraInfo();
  info.roi.x_offset = 600;
  info.roi.width = 100;
  info.roi.height = 100;
  EXPECT_NE(errorOf(info).find("roi"), std::string::npos) << errorOf(info);
}

TEST(CameraInfo, RoundTrip) {
  const CameraCalibration calibration = calibrationFromCameraInfo(testCameraInfo());
  EXPECT_TRUE(calibrationFromCameraInfo(cameraInfoFromCalibration(calibration)) == calibration);
}

sensor_msgs::ImagePtr testMessage(const std::string& encoding, int channel_bytes, const std::vector<unsigned>& pixel) {
  auto message = boost::make_shared<sensor_msgs::Image>();
  message->encoding = encoding;
  message->width = 8;
  message->height = 6;
  message->step = static_cast<unsigned>(8 * pixel.size()) * static_cast<unsigned>(channel_bytes);
  for (int i = 0; i < 48; ++i) {
    for (const unsigned value : pixel) {
      for (int byte = 0; byte < channel_bytes; ++byte) {
        message->data.push_back(static_cast<unsigned char>(value >> (8 * byte)));
      }
    }
  }
  return message;
}

TEST(ImageConversion, GreyImagesAreShared) {
  const sensor_msgs::ImageConstPtr message = testMessage("mono8", 1, {77});
  EXPECT_EQ(toCvImage(message)->image.data, message->data.data());
}

TEST(ImageConversion, EncodingsKeepTheirBrightness) {
  EXPECT_EQ(toCvImage(testMessage("16UC1", 2, {40000}))->image.at<std::uint16_t>(1, 1), 40000);
  EXPECT_EQ(toCvImage(testMessage("bgr8", 1, {1, 2, 3}))->image.at<cv::Vec3b>(1, 1), cv::Vec3b(1, 2, 3));
  EXPECT_EQ(toCvImage(testMessage("8UC3", 1, {1, 2, 3}))->image.at<cv::Vec3b>(1, 1), cv::Vec3b(1, 2, 3));
  // Red is 30 % of grey, blue 11 %: tells rgb from bgr.
  EXPECT_NEAR(toCvImage(testMessage("rgb8", 1, {200, 0, 0}))->image.at<unsigned char>(1, 1), 60, 1);
  EXPECT_NEAR(toCvImage(testMessage("rgb16", 2, {50000, 0, 0}))->image.at<std::uint16_t>(1, 1), 14950, 5);
  EXPECT_EQ(toCvImage(testMessage("bayer_rggb8", 1, {90}))->image.at<unsigned char>(2, 2), 90);
}

TEST(ImageConversion, OtherEncodingsAreNamed) {
  try {
    toCvImage(testMessage("32FC1", 4, {0}));
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("32FC1"), std::string::npos);
  }
}

TEST(ExposureLookup, MatchesByStamp) {
  ExposureLookup lookup;
  lookup.add(1'000'000'000, 0.01);
  lookup.add(1'040'000'000, 0.02);
  EXPECT_DOUBLE_EQ(lookup.find(1'040'000'200).value(), 0.02);  // rounded through a double
  EXPECT_FALSE(lookup.find(1'020'000'000).has_value());
  EXPECT_TRUE(lookup.hasLater(1'020'000'000));
  EXPECT_FALSE(lookup.hasLater(1'040'000'000));
  lookup.forgetBefore(1'040'000'000);
  EXPECT_FALSE(lookup.find(1'000'000'000).has_value());
  EXPECT_EQ(lookup.size(), 1U);
}

TEST(Conversions, FramesOfCamerasAreThoseOfTf) {
  EXPECT_EQ(cameraFrame("camera_optical"), "camera_optical");
  EXPECT_EQ(cameraFrame("/camera"), "camera");
  EXPECT_EQ(cameraFrame("1234500"), "");
  EXPECT_EQ(cameraFrame(""), "");
  EXPECT_EQ(cameraFrame("cam0"), "cam0");
}

}  // namespace
}  // namespace mba_vo::conversions_test
