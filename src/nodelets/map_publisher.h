#pragma once

#include <string>

#include <ros/node_handle.h>

#include "mba_vo/mapping/mapper.h"
#include "mba_vo/ros/node_config.h"

namespace mba_vo {

/// Publishes what the mapper knows: path, points, and the images of keyframes, only if anybody listens and not
/// more often than asked for.
class MapPublisher {
 public:
  MapPublisher(ros::NodeHandle& nh, const NodeConfig& config);

  /// After each frame. `T_base_camera` of the camera that sees the map.
  void publish(const Mapper& mapper, const SE3& T_base_camera, const ros::Time& stamp);
  void publishKeyframe(const Reference& reference, const std::string& camera_frame, const ros::Time& stamp);
  /// Whether anybody looks at sharp keyframes.
  bool wantsSharpKeyframes() const;
  /// With it the same keyframe as it came.
  void publishSharpKeyframe(const SharpKeyframe& keyframe, const std::string& camera_frame);

 private:
  /// Whether a topic is wanted and due; if so it counts as published.
  static bool due(const ros::Publisher& publisher, double period, ros::SteadyTime& last);

  std::string map_frame_;
  double path_period_;    // [s]
  double points_period_;  // [s]
  ros::Publisher path_;
  ros::Publisher points_;
  ros::Publisher keyframe_image_;
  ros::Publisher sharp_keyframe_;
  ros::Publisher original_keyframe_;  // of the sharp one
  ros::SteadyTime last_path_;
  ros::SteadyTime last_points_;
};

}  // namespace mba_vo
