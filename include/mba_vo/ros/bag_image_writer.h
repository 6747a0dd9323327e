#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <rosbag/bag.h>
#include <sensor_msgs/CameraInfo.h>
#include <std_msgs/Header.h>
#include <opencv2/core.hpp>

#include "mba_vo/image/frame_builder.h"
#include "mba_vo/ros/conversions.h"

namespace mba_vo {

/// Writes images into a bag (LZ4) as a camera driver would publish them: /camera/image_raw, /camera/camera_info and
/// /camera/exposure (NaN = unknown) with equal stamps, recorded when the exposure has ended.
class BagImageWriter {
 public:
  static constexpr const char* kDepthTopic = "/camera/depth";  // 32FC1 [m], of the image with the same stamp

  /// Throws std::runtime_error naming the file if it cannot be written.
  BagImageWriter(const std::string& file, const CameraCalibration& calibration, StampReference stamp_reference);

  /// Throws std::runtime_error for times that a bag cannot hold.
  void write(std::int64_t mid_exposure_ns, std::optional<double> exposure, const cv::Mat& image);
  void writeImage(const std::string& topic, const cv::Mat& image);

  /// Header and time of recording of the image written last, for what belongs to it.
  const std_msgs::Header& header() const { return header_; }
  template <typename Message>
  void writeMessage(const std::string& topic, const Message& message) {
    bag_.write(topic, record_time_, message);
  }
  void close() { bag_.close(); }

 private:
  rosbag::Bag bag_;
  sensor_msgs::CameraInfo camera_info_;
  StampReference stamp_reference_;
  std_msgs::Header header_;
  ros::Time record_time_;
};

}  // namespace mba_vo
