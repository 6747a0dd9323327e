#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Transform.h>
#include <geometry_msgs/Vector3.h>
#include <ros/time.h>

#include "mba_vo/geometry/se3.h"

namespace mba_vo {

ros::Time toRosTime(std::int64_t nanoseconds);
std::int64_t toNanoseconds(const ros::Time& time);

geometry_msgs::Vector3 toVector3Msg(const Eigen::Vector3d& vector);
geometry_msgs::Pose toPoseMsg(const SE3& T);
geometry_msgs::Transform toTransformMsg(const SE3& T);
SE3 fromTransformMsg(const geometry_msgs::Transform& transform);

/// Optical axes (z forward, x right, y down) seen from the body axes of REP-103 (x forward, y left, z up):
/// the extrinsic of a camera that nothing else is known about.
SE3 T_body_optical();

/// A camera motion written as the motion of the base that carries it: T_base_camera T T_base_camera^-1. The origin of
/// the base's world is the base, at the moment when the camera was at the origin of its own.
SE3 toBaseWorld(const SE3& T_world_camera, const SE3& T_base_camera);

/// The name of a camera's frame in TF, by the `frame_id` of its images: without the leading slash of old drivers, which
/// TF no longer knows; empty where a number stands in its place, as the exposure does in some bags.
std::string cameraFrame(const std::string& frame_id);

/// What the stamp of an image message refers to.
enum class StampReference { kStart, kMiddle, kEnd };

/// "start", "middle" or "end"; throws std::invalid_argument naming the value otherwise.
StampReference parseStampReference(const std::string& text);
const char* toString(StampReference reference);

/// Middle of the exposure [ns]. With unknown exposure the stamp is taken as the middle.
std::int64_t midExposure(std::int64_t stamp_ns, std::optional<double> exposure, StampReference reference);

/// The stamp of an image whose middle of exposure is known [ns]: the inverse.
std::int64_t stampOf(std::int64_t mid_exposure_ns, std::optional<double> exposure, StampReference reference);

/// Exposure [s] in a message: NaN = unknown.
std::optional<double> exposureFromMessage(double exposure_time);
double exposureToMessage(std::optional<double> exposure);

}  // namespace mba_vo
