#include "mba_vo/ros/node_config.h"

#include <gtest/gtest.h>

namespace mba_vo::node_config_test {
namespace {

std::string errorOf(const std::string& yaml) {
  try {
    parseNodeConfig(YAML::Load(yaml));
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(NodeConfig, OptionsOfRosAndOfTheOdometryAreReadTogether) {
  const NodeConfig config =
      parseNodeConfig(YAML::Load("{odom_frame: vo, exposure_time: 0.01, tracker: {max_points: 123}}"));
  EXPECT_EQ(config.frames.odom_frame, "vo");
  EXPECT_DOUBLE_EQ(config.fixedExposure().value(), 0.01);
  EXPECT_EQ(config.odometry.tracker.max_points, 123);
  EXPECT_EQ(config.odometry.mapper.tracker.max_points, 123);  // what follows from it follows
}

TEST(NodeConfig, ExposureMayBeLeftToTheTopic) {
  EXPECT_FALSE(parseNodeConfig(YAML::Load("{}")).fixedExposure().has_value());
  EXPECT_FALSE(parseNodeConfig(YAML::Load("{exposure_time: nan}")).fixedExposure().has_value());
  EXPECT_DOUBLE_EQ(parseNodeConfig(YAML::Load("{exposure_time: 0}")).fixedExposure().value(), 0.0);
}

TEST(NodeConfig, WrongOptionsAreNamed) {
  EXPECT_NE(errorOf("{oddom_frame: x}").find("oddom_frame"), std::string::npos);
  EXPECT_NE(errorOf("{tracker: {max_point: 3}}").find("max_point"), std::string::npos);
  EXPECT_NE(errorOf("{tracer: {max_points: 100}}").find("tracer"), std::string::npos);
  EXPECT_NE(errorOf("{image_queue_mb: -1}").find("image_queue_mb"), std::string::npos);
  EXPECT_NE(errorOf("{stamp_reference: centre}").find("'centre'"), std::string::npos);
  EXPECT_NE(errorOf("{exposure_time: -0.01}").find("-0.01"), std::string::npos);
  EXPECT_NE(errorOf("{exposure_time: long}").find("'long'"), std::string::npos);
}

TEST(NodeConfig, FramesThatTfCannotHoldAreRefused) {
  EXPECT_NE(errorOf("{map_frame: odom}").find("odom_frame is 'odom', as map_frame"), std::string::npos);
  EXPECT_NE(errorOf("{exposure_end_frame: base_link}").find("base_frame"), std::string::npos);
  EXPECT_NE(errorOf("{base_frame: ''}").find("base_frame is ''"), std::string::npos);
  EXPECT_NE(errorOf("{odom_frame: /odom}").find("'/odom'"), std::string::npos);
  EXPECT_EQ(errorOf("{map_frame: world, odom_frame: map}"), "");
}

}  // namespace
}  // namespace mba_vo::node_config_test
