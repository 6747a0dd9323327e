#pragma once

#include <vector>

#include <geometry_msgs/TransformStamped.h>
#include <ros/node_handle.h>
#include <tf2_ros/transform_broadcaster.h>

#include "mba_vo/ros/motion_messages.h"
#include "mba_vo/ros/node_config.h"

namespace mba_vo {

/// Publishes measured motions: odometry, pose, exposure_motion and TF.
class MotionPublisher {
 public:
  MotionPublisher(ros::NodeHandle& nh, const FrameNames& frames, bool publish_tf);

  void publish(const MeasuredMotion& motion);
  /// Of a pose that has been published before, under the stamp of another image.
  void publishExposureMotion(const MeasuredMotion& motion);
  /// A pose that was predicted is in TF alone: map -> odom -> base, where nothing was exposed that is known.
  void publishPrediction(const MeasuredMotion& motion);

 private:
  std::vector<geometry_msgs::TransformStamped> transforms(const MeasuredMotion& motion) const;
  void broadcast(const MeasuredMotion& motion, const ExposureMotion& exposure_motion);

  FrameNames frames_;
  bool publish_tf_;
  ros::Publisher odometry_;
  ros::Publisher pose_;
  ros::Publisher exposure_motion_;
  tf2_ros::TransformBroadcaster broadcaster_;
};

}  // namespace mba_vo
