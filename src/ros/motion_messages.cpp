#include "mba_vo/ros/motion_messages.h"

#include <Eigen/Cholesky>

#include "mba_vo/ros/conversions.h"

namespace mba_vo {
namespace {

boost::array<double, 36> toArray(const Matrix6& matrix) {
  boost::array<double, 36> array;
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      array[static_cast<std::size_t>(6 * row + column)] = matrix(row, column);
    }
  }
  return array;
}

}  // namespace

ExposureTrajectory exposureInOdom(const MeasuredMotion& motion) {
  return {motion.T_odom_camera, motion.motion.velocity, motion.tracked->trajectory.exposure,
          motion.motion.acceleration};
}

Matrix6 poseCovariance(const Matrix6& camera_increment, const SE3& T_base_camera, const SE3& T_world_base) {
  // T_b T Exp(d) T_b^-1 = (T_b T T_b^-1) Exp(Ad d): the increment seen in the base; then turned into the parent's axes.
  Matrix6 J = Matrix6::Zero();
  J.topLeftCorner<3, 3>() = T_world_base.rotationMatrix();
  J.bottomRightCorner<3, 3>() = T_world_base.rotationMatrix();
  J = J * T_base_camera.adjoint();
  return J * camera_increment * J.transpose();
}

double motionConfidence(const TrackedFrame& tracked) {
  if (tracked.xi_prior_limited) {
    return 0.0;
  }
  const Vector6 xi = tracked.trajectory.xi();
  const Eigen::LDLT<Matrix6> covariance(tracked.covariance.bottomRightCorner<6, 6>());
  if (covariance.info() != Eigen::Success || !covariance.isPositive() || !(covariance.vectorD().minCoeff() > 0.0)) {
    return 0.0;
  }
  const double squared_length = xi.dot(covariance.solve(xi));
  return squared_length > 6.0 ? 1.0 - 6.0 / squared_length : 0.0;
}

nav_msgs::Odometry makeOdometry(const MeasuredMotion& motion, const FrameNames& frames) {
  const TrackedFrame& tracked = *motion.tracked;
  const SE3 T_odom_base = toBaseWorld(motion.T_odom_camera, motion.T_base_camera);
  const Matrix6 Ad = motion.T_base_camera.adjoint();
  const Vector6 velocity = Ad * motion.motion.velocity;

  nav_msgs::Odometry odometry;
  odometry.header.stamp = toRosTime(tracked.frame->mid_exposure_ns);
  odometry.header.frame_id = frames.odom_frame;
  odometry.child_frame_id = frames.base_frame;
  odometry.pose.pose = toPoseMsg(T_odom_base);
  odometry.pose.covariance = toArray(poseCovariance(motion.covariance.odom, motion.T_base_camera, T_odom_base));
  odometry.twist.twist.linear = toVector3Msg(velocity.head<3>());
  odometry.twist.twist.angular = toVector3Msg(velocity.tail<3>());
  odometry.twist.covariance = toArray(Ad * motion.covariance.velocity * Ad.transpose());
  return odometry;
}

geometry_msgs::PoseWithCovarianceStamped makePose(const MeasuredMotion& motion, const FrameNames& frames) {
  const TrackedFrame& tracked = *motion.tracked;
  const SE3 T_map_base = toBaseWorld(motion.T_map_odom * motion.T_odom_camera, motion.T_base_camera);
  geometry_msgs::PoseWithCovarianceStamped pose;
  pose.header.stamp = toRosTime(tracked.frame->mid_exposure_ns);
  pose.header.frame_id = frames.map_frame;
  pose.pose.pose = toPoseMsg(T_map_base);
  pose.pose.covariance = toArray(poseCovariance(motion.covariance.map, motion.T_base_camera, T_map_base));
  return pose;
}

ExposureMotion makeExposureMotion(const MeasuredMotion& motion, const FrameNames& frames) {
  const TrackedFrame& tracked = *motion.tracked;
  const ExposureTrajectory in_odom = exposureInOdom(motion);
  ExposureMotion message;
  message.header.stamp = toRosTime(tracked.frame->stamp_ns);
  message.header.frame_id = frames.odom_frame;
  message.child_frame_id = motion.camera_frame;
  message.mid_time = toRosTime(tracked.frame->mid_exposure_ns);
  // The first orientation before a map is no motion within an exposure yet.
  const double exposure = in_odom.exposure;
  message.exposure_time = exposure > 0.0 ? exposure : exposureToMessage(tracked.frame->exposure);
  // The world of the base is that of the camera seen through the extrinsic.
  message.start = toPoseMsg(motion.T_base_camera * in_odom.start());
  message.end = toPoseMsg(motion.T_base_camera * in_odom.end());
  message.blur_length = tracked.measures.blur_length_px;
  message.confidence = motionConfidence(tracked);
  message.map_id = tracked.orientation_only ? 0 : tracked.reference.map_id;
  message.keyframe_id = tracked.reference.keyframe_id;
  message.revision = tracked.reference.revision;
  return message;
}

}  // namespace mba_vo
