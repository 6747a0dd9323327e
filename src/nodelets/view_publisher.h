#pragma once

#include <string>

#include <ros/node_handle.h>

#include "mba_vo/ros/motion_messages.h"

namespace mba_vo {

/// Publishes what is there to be looked at, tracking/image and markers. Nothing is drawn while nobody listens.
class ViewPublisher {
 public:
  ViewPublisher(ros::NodeHandle& nh, const std::string& map_frame);

  /// Of every image. `reference`: the newest that the tracker has; may be null.
  void publishImage(const TrackedFrame& tracked, const ReferenceConstPtr& reference, const std::string& camera_frame);
  /// Of every image with a measured pose.
  void publishMarkers(const MeasuredMotion& motion, const ReferenceConstPtr& reference);
  /// The map is no more.
  void clearMarkers();

 private:
  std::string map_frame_;
  ros::Publisher image_;
  ros::Publisher markers_;
};

}  // namespace mba_vo
