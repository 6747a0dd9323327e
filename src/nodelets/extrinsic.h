#pragma once

#include <memory>
#include <optional>
#include <string>

#include <ros/time.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include "mba_vo/geometry/se3.h"

namespace mba_vo {

/// Pose of the camera on the base, from TF, once for each camera. If TF knows none in time, the base is the camera
/// itself with the axes of REP-103.
class Extrinsic {
 public:
  /// `wait` [s] of wall time from a camera's first image on. A TF that knows neither of the two frames has nothing to
  /// tell, if it had that long since this began to listen: then poses wait no longer than a map takes to begin.
  Extrinsic(std::string base_frame, double wait);

  /// From now on images of this camera (optical frame) come.
  void setCamera(const std::string& camera_frame);
  /// Looks without waiting. False while TF may still tell.
  bool isSettled();
  /// Waits until it is settled.
  const SE3& T_base_camera();

 private:
  bool isTimeUp() const;

  const std::string base_frame_;
  const ros::WallDuration wait_;
  std::optional<std::string> camera_frame_;
  // Simulated time may stand still until the first image has been dealt with.
  const ros::SteadyTime listening_since_ = ros::SteadyTime::now();
  ros::SteadyTime first_image_;
  tf2_ros::Buffer buffer_;
  std::unique_ptr<tf2_ros::TransformListener> listener_;  // while it is not settled
  std::optional<SE3> T_base_camera_;
};

}  // namespace mba_vo
