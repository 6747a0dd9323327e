#include "mba_vo/ros/conversions.h"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace mba_vo {

ros::Time toRosTime(std::int64_t nanoseconds) {
  ros::Time time;
  time.fromNSec(static_cast<std::uint64_t>(nanoseconds));
  return time;
}

std::int64_t toNanoseconds(const ros::Time& time) { return static_cast<std::int64_t>(time.toNSec()); }

geometry_msgs::Vector3 toVector3Msg(const Eigen::Vector3d& vector) {
  geometry_msgs::Vector3 message;
  message.x = vector.x();
  message.y = vector.y();
  message.z = vector.z();
  return message;
}

namespace {

geometry_msgs::Quaternion toQuaternionMsg(const Eigen::Quaterniond& rotation) {
  geometry_msgs::Quaternion message;
  message.x = rotation.x();
  message.y = rotation.y();
  message.z = rotation.z();
  message.w = rotation.w();
  return message;
}

}  // namespace

geometry_msgs::Pose toPoseMsg(const SE3& T) {
  geometry_msgs::Pose pose;
  pose.position.x = T.translation().x();
  pose.position.y = T.translation().y();
  pose.position.z = T.translation().z();
  pose.orientation = toQuaternionMsg(T.rotation());
  return pose;
}

geometry_msgs::Transform toTransformMsg(const SE3& T) {
  geometry_msgs::Transform transform;
  transform.translation = toVector3Msg(T.translation());
  transform.rotation = toQuaternionMsg(T.rotation());
  return transform;
}

SE3 fromTransformMsg(const geometry_msgs::Transform& transform) {
  const auto& q = transform.rotation;
  const auto& p = transform.translation;
  return SE3(Eigen::Quaterniond(q.w, q.x, q.y, q.z), Eigen::Vector3d(p.x, p.y, p.z));
}

SE3 T_body_optical() {
  Eigen::Matrix3d R;   // columns: optical x = -body y, optical y = -body z, optical z = body x
  R << 0.0, 0.0, 1.0,  //
      -1.0, 0.0, 0.0,  //
      0.0, -1.0, 0.0;
  return SE3(Eigen::Quaterniond(R), Eigen::Vector3d::Zero());
}

SE3 toBaseWorld(const SE3& T_world_camera, const SE3& T_base_camera) {
  return T_base_camera * T_world_camera * T_base_camera.inverse();
}

std::string cameraFrame(const std::string& frame_id) {
  if (frame_id.find_first_not_of("0123456789") == std::string::npos) return "";
  return frame_id.front() == '/' ? frame_id.substr(1) : frame_id;
}

StampReference parseStampReference(const std::string& text) {
  for (const StampReference reference : {StampReference::kStart, StampReference::kMiddle, StampReference::kEnd}) {
    if (text == toString(reference)) {
      return reference;
    }
  }
  throw std::invalid_argument("stamp_reference is '" + text + "'; allowed: start, middle, end");
}

const char* toString(StampReference reference) {
  switch (reference) {
    case StampReference::kStart:
      return "start";
    case StampReference::kMiddle:
      return "middle";
    default:
      return "end";
  }
}

std::int64_t midExposure(std::int64_t stamp_ns, std::optional<double> exposure, StampReference reference) {
  if (!exposure || reference == StampReference::kMiddle) {
    return stamp_ns;
  }
  const std::int64_t half = std::llround(0.5e9 * *exposure);
  return reference == StampReference::kStart ? stamp_ns + half : stamp_ns - half;
}

std::int64_t stampOf(std::int64_t mid_exposure_ns, std::optional<double> exposure, StampReference reference) {
  return 2 * mid_exposure_ns - midExposure(mid_exposure_ns, exposure, reference);
}

std::optional<double> exposureFromMessage(double exposure_time) {
  return std::isnan(exposure_time) ? std::nullopt : std::make_optional(exposure_time);
}

double exposureToMessage(std::optional<double> exposure) {
  return exposure.value_or(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace mba_vo
