#include "mba_vo/ros/camera_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/temporary_folder.h"
#include "mba_vo/ros/calibration_keeper.h"

namespace mba_vo::camera_config_test {
namespace {

using testing::HasSubstr;

CameraConfig parse(const std::string& yaml) { return parseCameraConfig(YAML::Load(yaml)); }
std::string errorOf(const std::string& yaml) {
  return messageOf([&] { parse(yaml); });
}

TEST(CameraConfig, ParametersBecomeSettings) {
  const CameraConfig config = parse(
      "{device: 2, pixel_format: mjpeg, width: 1280, height: 720, rate: 25, exposure: 0.01, max_exposure: 0.02,"
      " image_raw: {compressed: {jpeg_quality: 80}}}");  // the last is image_transport's
  EXPECT_EQ(config.camera.device.path, "2");
  EXPECT_EQ(config.camera.device.format.pixel_format, "mjpeg");
  EXPECT_EQ(config.camera.device.format.height, 720);
  EXPECT_EQ(config.camera.device.format.rate, 25.0);
  EXPECT_EQ(config.camera.device.exposure.seconds, 0.01);
  EXPECT_EQ(config.camera.device.exposure.longest, 0.02);
  EXPECT_FALSE(parse("{}").camera.device.exposure.seconds.has_value());
}

TEST(CameraConfig, ACameraIsChosenFromTheCalibrationThatIsNamedElseFromTheRecordings) {
  EXPECT_EQ(parse("{calibration_camera: cam1}").camera.camera, "cam1");
  const CameraConfig named = parse("{calibration_camera: cam1, camera_info_url: /rig.yaml}");
  EXPECT_EQ(named.camera.camera, "");
  EXPECT_EQ(named.calibration_camera, "cam1");
}

TEST(CameraConfig, WrongParametersAreNamed) {
  EXPECT_THAT(errorOf("{devise: 0}"), HasSubstr("devise"));
  EXPECT_THAT(errorOf("{exposure: short}"), HasSubstr("exposure is 'short'"));
  EXPECT_THAT(errorOf("{width: -1}"), HasSubstr("width"));
  EXPECT_THAT(errorOf("{rate: fast}"), HasSubstr("rate"));
  EXPECT_THAT(errorOf("{stamp_reference: centre}"), HasSubstr("'centre'"));
}

TEST(CameraConfig, AGuessedCalibrationSeesTheFieldOfView) {
  const sensor_msgs::CameraInfo info = guessedCameraInfo({640, 480}, 90.0);
  EXPECT_NEAR(info.K[0], 320.0, 1e-9);
  EXPECT_NEAR(info.K[4], 320.0, 1e-9);
  EXPECT_NEAR(info.K[2], 319.5, 1e-9);
  EXPECT_EQ(info.width, 640U);
}

}  // namespace
}  // namespace mba_vo::camera_config_test
