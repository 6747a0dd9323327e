#pragma once

#include <memory>
#include <string>

#include <gtest/gtest.h>
#include <mba_vo/ExposureStamped.h>
#include <sensor_msgs/CameraInfo.h>
#include <boost/make_shared.hpp>

#include "live_odometry.h"
#include "mba_vo/ros/camera_info.h"
#include "mba_vo/ros/conversions.h"

namespace mba_vo {

inline constexpr double kTimeout = 20.0;  // [s]
inline constexpr std::int64_t kFirstStamp = 1'000'000'000'000;
inline constexpr std::int64_t kInterval = 50'000'000;

/// A camera that can be told to misbehave, and the nodelets, in a namespace of their own.
class BadInput : public testing::Test {
 protected:
  BadInput()
      : name_(testing::UnitTest::GetInstance()->current_test_info()->name()),
        nh_("/" + name_ + "_camera"),
        images_(nh_.advertise<sensor_msgs::Image>("image_raw", 100)),
        infos_(nh_.advertise<sensor_msgs::CameraInfo>("camera_info", 100)),
        exposures_(nh_.advertise<ExposureStamped>("exposure", 100)) {
    ros::NodeHandle parameters("/" + name_);
    parameters.setParam("extrinsic_wait", 0.0);
    parameters.setParam("calibration_wait", 0.3);
    parameters.setParam("exposure_wait", 0.2);
    parameters.setParam("publish_tf", false);
    odometry_ = std::make_unique<LiveOdometry>("/" + name_, "/" + name_ + "_camera");
    waitForSubscribers(images_);
    waitForSubscribers(infos_);
    waitForSubscribers(exposures_);
  }

  static void waitForSubscribers(const ros::Publisher& publisher) {
    const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(kTimeout);
    while (publisher.getNumSubscribers() == 0 && ros::WallTime::now() < deadline) {
      ros::WallDuration(0.01).sleep();
    }
  }

  void sendCameraInfo(double focal_length = 150.0) {
    CameraCalibration calibration;
    calibration.width = 160;
    calibration.height = 120;
    calibration.fx = calibration.fy = focal_length;
    calibration.cx = 79.5;
    calibration.cy = 59.5;
    infos_.publish(cameraInfoFromCalibration(calibration));
    ros::WallDuration(0.2).sleep();  // it has a queue of its own
  }

  void sendImage(std::int64_t stamp_ns, const std::string& encoding = "mono8", unsigned width = 160,
                 unsigned bytes_per_pixel = 1) {
    grey_ += 3;  // no image repeats another
    sendImageAgain(stamp_ns, encoding, width, bytes_per_pixel);
  }

  /// What the last one showed.
  void sendImageAgain(std::int64_t stamp_ns, const std::string& encoding = "mono8", unsigned width = 160,
                      unsigned bytes_per_pixel = 1) {
    // Handed over as a pointer, the message keeps its sequence number; serialised, it would be given the next one.
    const auto image = boost::make_shared<sensor_msgs::Image>();
    image->header.stamp = toRosTime(stamp_ns);
    image->header.frame_id = "camera";
    image->header.seq = sequence_++;
    image->encoding = encoding;
    image->width = width;
    image->height = 120;
    image->step = width * bytes_per_pixel;
    image->data.assign(image->step * image->height, grey_);
    images_.publish(sensor_msgs::ImageConstPtr(image));
    ++sent_;
  }

  void sendExposure(std::int64_t stamp_ns, double exposure) {
    ExposureStamped message;
    message.header.stamp = toRosTime(stamp_ns);
    message.exposure_time = exposure;
    exposures_.publish(message);
  }

  static std::int64_t stamp(int index) { return kFirstStamp + index * kInterval; }
  bool done() const { return odometry_->waitUntilDone(sent_, kTimeout); }

  /// Whether a status with this image's stamp gives a reason that contains `text`.
  bool hasReason(std::int64_t stamp_ns, const std::string& text) const {
    for (const auto& status : odometry_->outputs().status) {
      if (toNanoseconds(status->header.stamp) == stamp_ns && status->reason.find(text) != std::string::npos) {
        return true;
      }
    }
    return false;
  }

  std::string name_;
  ros::NodeHandle nh_;
  ros::Publisher images_, infos_, exposures_;
  std::unique_ptr<LiveOdometry> odometry_;
  std::uint64_t sent_ = 0;
  std::uint32_t sequence_ = 0;
  std::uint8_t grey_ = 100;
};

}  // namespace mba_vo
