#include "extrinsic.h"

#include <utility>

#include <ros/ros.h>

#include "mba_vo/ros/conversions.h"

namespace mba_vo {

namespace {

const ros::WallDuration kWaitForAnything(0.2);  // a map takes longer to begin: docs/decisions/2026-11-29-first-pose.md

}  // namespace

Extrinsic::Extrinsic(std::string base_frame, double wait)
    : base_frame_(std::move(base_frame)),
      wait_(wait),
      listener_(std::make_unique<tf2_ros::TransformListener>(buffer_)) {}

void Extrinsic::setCamera(const std::string& camera_frame) {
  if (camera_frame_ == camera_frame) {
    return;
  }
  camera_frame_ = camera_frame;
  T_base_camera_.reset();
  first_image_ = ros::SteadyTime::now();
  if (!listener_) {
    listener_ = std::make_unique<tf2_ros::TransformListener>(buffer_);
  }
}

bool Extrinsic::isTimeUp() const {
  const ros::SteadyTime now = ros::SteadyTime::now();
  if (now >= first_image_ + wait_ || !ros::ok()) {
    return true;
  }
  const bool known = buffer_._frameExists(base_frame_) || buffer_._frameExists(*camera_frame_);
  return !known && now >= first_image_ + kWaitForAnything && now >= listening_since_ + wait_;
}

bool Extrinsic::isSettled() {
  if (T_base_camera_) {
    return true;
  }
  const std::string camera = camera_frame_.value_or("");
  if (camera == base_frame_) {
    T_base_camera_ = SE3();
  } else if (!camera.empty() && buffer_.canTransform(base_frame_, camera, ros::Time(0))) {
    ROS_INFO_STREAM("camera '" << camera << "' is mounted on '" << base_frame_ << "' as TF says");
    T_base_camera_ = fromTransformMsg(buffer_.lookupTransform(base_frame_, camera, ros::Time(0)).transform);
  } else if (camera.empty() || isTimeUp()) {
    ROS_INFO_STREAM("TF has no transform from '" << base_frame_ << "' to camera '" << camera << "': '" << base_frame_
                                                 << "' is the camera itself, x forward, z up");
    T_base_camera_ = T_body_optical();
  }
  if (T_base_camera_) {
    listener_.reset();
  }
  return T_base_camera_.has_value();
}

const SE3& Extrinsic::T_base_camera() {
  while (!isSettled()) {
    ros::WallDuration(0.02).sleep();
  }
  return *T_base_camera_;
}

}  // namespace mba_vo
