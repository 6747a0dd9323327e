#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include <image_transport/image_transport.h>
#include <ros/ros.h>

#include "mba_vo/ros/calibration_keeper.h"
#include "mba_vo/ros/camera_config.h"

namespace mba_vo {

/// Publishes what a camera, or a recording played like one, gives: image_raw, camera_info and exposure below `nh`, with
/// equal stamps. Recordings wait for somebody who listens to image_raw. Says on the console what happens to it.
class CameraDriver {
 public:
  /// Opens the camera and begins. Throws CameraError or std::invalid_argument naming what is wrong.
  CameraDriver(const ros::NodeHandle& nh, const CameraConfig& config,
               const std::shared_ptr<DeviceCalls>& calls = kernelCalls());
  ~CameraDriver();
  CameraDriver(const CameraDriver&) = delete;
  CameraDriver& operator=(const CameraDriver&) = delete;

  /// Whether a recording has come to its end.
  bool ended() const { return ended_; }

 private:
  void run();
  void waitForListener() const;
  void publish(const CapturedImage& captured);
  void tellCalibration(const cv::Size& size);

  ros::NodeHandle nh_;
  const CameraConfig config_;
  std::unique_ptr<CameraSource> camera_;
  std::unique_ptr<CalibrationKeeper> calibration_;
  image_transport::Publisher image_publisher_;
  ros::Publisher info_publisher_;
  ros::Publisher exposure_publisher_;
  std::string last_problem_;  // of the calibration
  std::uint64_t published_ = 0;
  std::atomic<bool> running_{true};
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

}  // namespace mba_vo
