#include "view_publisher.h"

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/image_encodings.h>

#include "mba_vo/ros/conversions.h"
#include "mba_vo/ros/motion_markers.h"
#include "mba_vo/ros/tracking_image.h"

namespace mba_vo {

ViewPublisher::ViewPublisher(ros::NodeHandle& nh, const std::string& map_frame)
    : map_frame_(map_frame),
      image_(nh.advertise<sensor_msgs::Image>("tracking/image", 2)),
      markers_(nh.advertise<visualization_msgs::MarkerArray>("markers", 10)) {}

void ViewPublisher::publishImage(const TrackedFrame& tracked, const ReferenceConstPtr& reference,
                                 const std::string& camera_frame) {
  if (image_.getNumSubscribers() == 0) return;
  std_msgs::Header header;
  header.frame_id = camera_frame;
  header.stamp = toRosTime(tracked.frame->stamp_ns);
  image_.publish(
      cv_bridge::CvImage(header, sensor_msgs::image_encodings::BGR8, drawTracking(tracked, reference)).toImageMsg());
}

void ViewPublisher::publishMarkers(const MeasuredMotion& motion, const ReferenceConstPtr& reference) {
  if (markers_.getNumSubscribers() == 0 || !reference) return;
  markers_.publish(makeMarkers(motion, *reference, map_frame_));
}

void ViewPublisher::clearMarkers() {
  if (markers_.getNumSubscribers() > 0) markers_.publish(deleteMarkers());
}

}  // namespace mba_vo
