#include "extrinsic.h"

#include <ros/ros.h>
#include <tf2_ros/transform_listener.h>

#include "mba_vo/ros/conversions.h"

namespace mba_vo {

SE3 lookupExtrinsic(const std::string& base_frame, const std::string& camera_frame, double wait) {
  if (camera_frame == base_frame) {
    return SE3();
  }
  tf2_ros::Buffer buffer;
  const tf2_ros::TransformListener listener(buffer);
  // Wall time: simulated time may stand still until the first image has been dealt with.
  const ros::SteadyTime deadline = ros::SteadyTime::now() + ros::WallDuration(wait);
  while (ros::ok() && !camera_frame.empty()) {
    if (buffer.canTransform(base_frame, camera_frame, ros::Time(0))) {
      ROS_INFO_STREAM("camera '" << camera_frame << "' is mounted on '" << base_frame << "' as TF says");
      return fromTransformMsg(buffer.lookupTransform(base_frame, camera_frame, ros::Time(0)).transform);
    }
    if (ros::SteadyTime::now() >= deadline) {
      break;
    }
    ros::WallDuration(0.02).sleep();
  }
  ROS_INFO_STREAM("TF has no transform from '" << base_frame << "' to camera '" << camera_frame << "': '" << base_frame
                                               << "' is the camera itself, x forward, z up");
  return T_body_optical();
}

}  // namespace mba_vo
