#pragma once

#include <cerrno>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <rosbag/bag.h>
#include <sensor_msgs/CameraInfo.h>
#include <std_msgs/Header.h>
#include <opencv2/core.hpp>

#include "mba_vo/image/frame_builder.h"
#include "mba_vo/ros/bag_errors.h"
#include "mba_vo/ros/conversions.h"

namespace mba_vo {

/// Writes images into a bag (LZ4) as a camera driver would publish them: /camera/image_raw, /camera/camera_info and
/// /camera/exposure (NaN = unknown) with equal stamps, recorded when the exposure has ended. Whatever writes throws
/// std::runtime_error naming the file and the reason if it cannot be written, as on a full disk; nothing can be written
/// then any more.
class BagImageWriter {
 public:
  static constexpr const char* kDepthTopic = "/camera/depth";  // 32FC1 [m], of the image with the same stamp

  BagImageWriter(const std::string& file, const CameraCalibration& calibration, StampReference stamp_reference);

  ~BagImageWriter();
  BagImageWriter(const BagImageWriter&) = delete;
  BagImageWriter& operator=(const BagImageWriter&) = delete;

  /// Throws std::runtime_error for times that a bag cannot hold.
  void write(std::int64_t mid_exposure_ns, std::optional<double> exposure, const cv::Mat& image);
  void writeImage(const std::string& topic, const cv::Mat& image);

  /// Header and time of recording of the image written last, for what belongs to it.
  const std_msgs::Header& header() const { return header_; }
  template <typename Message>
  void writeMessage(const std::string& topic, const Message& message) {
    guarded([&] { bag_->write(topic, record_time_, message); });
  }
  void close() {
    guarded([&] { bag_->close(); });
  }

 private:
  template <typename Call>
  void guarded(const Call& call) {
    errno = 0;
    try {
      call();
    } catch (const rosbag::BagException& error) {
      const std::runtime_error failure = cannotWrite(file_, error);
      static_cast<void>(bag_.release());  // its destructor would write once more, throw, and so end the program
      throw failure;
    }
  }

  std::string file_;
  std::unique_ptr<rosbag::Bag> bag_;  // null after a failure
  sensor_msgs::CameraInfo camera_info_;
  StampReference stamp_reference_;
  std_msgs::Header header_;
  ros::Time record_time_;
};

}  // namespace mba_vo
