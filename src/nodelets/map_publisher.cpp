#include "map_publisher.h"

#include "mba_vo/ros/conversions.h"
#include "mba_vo/ros/map_messages.h"

namespace mba_vo {

MapPublisher::MapPublisher(ros::NodeHandle& nh, const NodeConfig& config)
    : map_frame_(config.frames.map_frame),
      path_period_(config.path_period),
      points_period_(config.points_period),
      path_(nh.advertise<nav_msgs::Path>("path", 1)),
      points_(nh.advertise<sensor_msgs::PointCloud2>("points", 1)),
      keyframe_image_(nh.advertise<sensor_msgs::Image>("keyframe/image", 2)),
      sharp_keyframe_(nh.advertise<sensor_msgs::Image>("keyframe/sharp", 2)),
      original_keyframe_(nh.advertise<sensor_msgs::Image>("keyframe/original", 2)) {}

void MapPublisher::publish(const Mapper& mapper, const SE3& T_base_camera, const ros::Time& stamp) {
  if (due(path_, path_period_, last_path_)) {
    path_.publish(makePath(mapper.trajectory(), T_base_camera, map_frame_, stamp));
  }
  if (due(points_, points_period_, last_points_)) {
    points_.publish(makePointCloud(mapper.points(), T_base_camera, map_frame_, stamp));
  }
}

void MapPublisher::publishKeyframe(const Reference& reference, const std::string& camera_frame,
                                   const ros::Time& stamp) {
  if (keyframe_image_.getNumSubscribers() > 0) {
    keyframe_image_.publish(makeKeyframeImage(*reference.pyramid, camera_frame, stamp));
  }
}

bool MapPublisher::wantsSharpKeyframes() const {
  return sharp_keyframe_.getNumSubscribers() > 0 || original_keyframe_.getNumSubscribers() > 0;
}

void MapPublisher::publishSharpKeyframe(const SharpKeyframe& keyframe, const std::string& camera_frame) {
  const ros::Time stamp = toRosTime(keyframe.frame->stamp_ns);
  if (original_keyframe_.getNumSubscribers() > 0) {
    original_keyframe_.publish(makeKeyframeImage(keyframe.frame->pyramid, camera_frame, stamp));
  }
  if (sharp_keyframe_.getNumSubscribers() > 0) {
    sharp_keyframe_.publish(makeKeyframeImage(*keyframe.image, camera_frame, stamp));
  }
}

bool MapPublisher::due(const ros::Publisher& publisher, double period, ros::SteadyTime& last) {
  const ros::SteadyTime now = ros::SteadyTime::now();
  if (publisher.getNumSubscribers() == 0 || (now - last).toSec() < period) {
    return false;
  }
  last = now;
  return true;
}

}  // namespace mba_vo
