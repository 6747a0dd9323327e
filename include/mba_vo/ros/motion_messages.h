#pragma once

#include <string>

#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <mba_vo/ExposureMotion.h>
#include <nav_msgs/Odometry.h>
#include <boost/array.hpp>

#include "mba_vo/ros/node_config.h"
#include "mba_vo/tracking/tracked_frame.h"
#include "mba_vo/trajectory/odometry_covariance.h"

namespace mba_vo {

/// One measured frame with all that is needed to tell ROS about it. Core frames (`odom`, `map`) have optical axes.
struct MeasuredMotion {
  TrackedFrameConstPtr tracked;
  SE3 T_odom_camera;  // at mid-exposure
  BodyMotion motion;  // about then, in the camera's axes
  SE3 T_map_odom;
  SE3 T_base_camera;
  std::string camera_frame;
  MotionCovariance covariance;
};

/// Camera to odom while the shutter is open, as published.
ExposureTrajectory exposureInOdom(const MeasuredMotion& motion);

/// Covariance in the order and meaning of geometry_msgs (x, y, z, rotation about the fixed axes x, y, z of the parent)
/// of a base pose, from that of a right increment (rho, phi) of the camera pose. `T_world_base` with REP-103 axes.
Matrix6 poseCovariance(const Matrix6& camera_increment, const SE3& T_base_camera, const SE3& T_world_base);

/// Share of the motion within the exposure that the blur itself measured, 0..1: 1 - n/m^2 with m^2 the squared
/// Mahalanobis length of the n = 6 components of xi, whose expectation would be n if there were no motion at all.
double motionConfidence(const TrackedFrame& tracked);

/// In odom, twist in the base frame, stamped at mid-exposure.
nav_msgs::Odometry makeOdometry(const MeasuredMotion& motion, const FrameNames& frames);
/// In map, stamped at mid-exposure.
geometry_msgs::PoseWithCovarianceStamped makePose(const MeasuredMotion& motion, const FrameNames& frames);
/// Camera (optical frame) in odom at the start and at the end of the exposure, with the input's stamp.
ExposureMotion makeExposureMotion(const MeasuredMotion& motion, const FrameNames& frames);

}  // namespace mba_vo
