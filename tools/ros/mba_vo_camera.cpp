// A camera, or a recording played like one, for rosrun: ~image_raw, ~camera_info and ~exposure, /camera/... by default.
#include <cstdio>
#include <exception>

#include <ros/ros.h>
#include <CLI/CLI.hpp>

#include "mba_vo/ros/camera_driver.h"
#include "mba_vo/ros/node_config.h"

namespace {

/// Ends with the recording, when what was published has had time to get out.
void runUntilEnd(const mba_vo::CameraDriver& driver) {
  constexpr double kPeriod = 0.1, kTimeToSend = 1.0;  // [s]
  ros::AsyncSpinner spinner(1);
  spinner.start();
  while (ros::ok() && !driver.ended()) ros::WallDuration(kPeriod).sleep();
  if (ros::ok()) ros::WallDuration(kTimeToSend).sleep();
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "camera");
  CLI::App app{
      "Publishes the images of a video device, or of a video file, image folder or sequence folder, as "
      "/camera/image_raw, "
      "/camera/camera_info and /camera/exposure. Parameters (docs/ros_api.md) are given as in\n"
      "  rosrun mba_vo mba_vo_camera _device:=/dev/video0 _width:=640 _height:=480 _rate:=30 _exposure:=0.01"};
  bool list = false;
  app.add_flag("--list", list, "print all video devices with their formats, sizes and rates, and end");
  CLI11_PARSE(app, argc, argv);
  if (list) {
    std::fputs(mba_vo::listDevices(mba_vo::kernelCalls()).c_str(), stdout);
    return 0;
  }
  const ros::NodeHandle nh("~");  // outlives the message below: with the last one the console ends
  try {
    runUntilEnd(mba_vo::CameraDriver(nh, mba_vo::parseCameraConfig(mba_vo::readParameters(nh))));
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM(error.what());
    return 1;
  }
  return 0;
}
