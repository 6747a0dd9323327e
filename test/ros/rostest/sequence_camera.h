#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>

#include "mba_vo/io/sequence.h"

namespace mba_vo {

/// The images of a recording, published one by one as by a camera, with the simulated clock.
class SequenceCamera {
 public:
  /// `ns`: namespace of its topics. `transport`: "raw", or "compressed": without loss, on image_raw/compressed.
  SequenceCamera(const std::string& ns, const std::vector<CameraImage>& images, const CameraCalibration& calibration,
                 const std::string& transport = "raw");

  /// Waits until somebody reads all topics; false after `timeout` [s].
  bool waitForReaders(double timeout) const;
  /// The image's time becomes the present. `covered`: the image shows nothing.
  void send(std::size_t index, bool covered = false);
  std::uint64_t sent() const { return sent_; }

 private:
  const std::vector<CameraImage>& images_;
  bool compressed_;
  sensor_msgs::CameraInfo info_;
  ros::NodeHandle nh_;
  ros::Publisher image_publisher_, info_publisher_, exposure_publisher_, clock_publisher_;
  std::uint64_t sent_ = 0;
};

}  // namespace mba_vo
