#include "motion_publisher.h"

#include "mba_vo/ros/conversions.h"

namespace mba_vo {
namespace {

constexpr std::uint32_t kQueue = 100;

geometry_msgs::TransformStamped makeTransform(const ros::Time& stamp, const std::string& parent,
                                              const std::string& child, const geometry_msgs::Pose& pose) {
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = stamp;
  transform.header.frame_id = parent;
  transform.child_frame_id = child;
  transform.transform.translation.x = pose.position.x;
  transform.transform.translation.y = pose.position.y;
  transform.transform.translation.z = pose.position.z;
  transform.transform.rotation = pose.orientation;
  return transform;
}

}  // namespace

MotionPublisher::MotionPublisher(ros::NodeHandle& nh, const FrameNames& frames, bool publish_tf)
    : frames_(frames),
      publish_tf_(publish_tf),
      odometry_(nh.advertise<nav_msgs::Odometry>("odometry", kQueue)),
      pose_(nh.advertise<geometry_msgs::PoseWithCovarianceStamped>("pose", kQueue)),
      exposure_motion_(nh.advertise<ExposureMotion>("exposure_motion", kQueue)) {}

void MotionPublisher::publish(const MeasuredMotion& motion) {
  const ExposureMotion exposure_motion = makeExposureMotion(motion, frames_);
  if (motion.tracked->orientation_only) {
    odometry_.publish(makeOdometry(motion, frames_));
    exposure_motion_.publish(exposure_motion);
    return;
  }
  if (publish_tf_) {
    broadcast(motion, exposure_motion);  // first, so that whoever gets a message finds its transform
  }
  odometry_.publish(makeOdometry(motion, frames_));
  pose_.publish(makePose(motion, frames_));
  exposure_motion_.publish(exposure_motion);
}

void MotionPublisher::publishExposureMotion(const MeasuredMotion& motion) {
  exposure_motion_.publish(makeExposureMotion(motion, frames_));
}

void MotionPublisher::publishPrediction(const MeasuredMotion& motion) {
  if (publish_tf_) {
    broadcaster_.sendTransform(transforms(motion));
  }
}

std::vector<geometry_msgs::TransformStamped> MotionPublisher::transforms(const MeasuredMotion& motion) const {
  const ros::Time stamp = toRosTime(motion.tracked->frame->mid_exposure_ns);
  const SE3 T_map_odom = toBaseWorld(motion.T_map_odom, motion.T_base_camera);
  const SE3 T_odom_base = toBaseWorld(motion.T_odom_camera, motion.T_base_camera);
  return {makeTransform(stamp, frames_.map_frame, frames_.odom_frame, toPoseMsg(T_map_odom)),
          makeTransform(stamp, frames_.odom_frame, frames_.base_frame, toPoseMsg(T_odom_base))};
}

void MotionPublisher::broadcast(const MeasuredMotion& motion, const ExposureMotion& exposure_motion) {
  // All at mid-exposure, also the frames of start and end: looked up together, they belong to one image.
  const ros::Time stamp = exposure_motion.mid_time;
  std::vector<geometry_msgs::TransformStamped> all = transforms(motion);
  all.push_back(makeTransform(stamp, frames_.odom_frame, frames_.exposure_start_frame, exposure_motion.start));
  all.push_back(makeTransform(stamp, frames_.odom_frame, frames_.exposure_end_frame, exposure_motion.end));
  broadcaster_.sendTransform(all);
}

}  // namespace mba_vo
