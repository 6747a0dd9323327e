#include "mba_vo/tracking/motion_prior.h"

namespace mba_vo {
namespace {

Vector6 informationOf(double translation_sigma, double rotation_sigma) {
  Vector6 information;
  information.head<3>().setConstant(1.0 / (translation_sigma * translation_sigma));
  information.tail<3>().setConstant(1.0 / (rotation_sigma * rotation_sigma));
  return information;
}

}  // namespace

ExposureTrajectory MotionPrior::predict(double exposure) const {
  return {previous.T_reference_mid * SE3::exp(dt * previous.velocity), previous.velocity, exposure};
}

std::vector<SE3> MotionPrior::alternatives() const {
  const Vector6 motion = dt * previous.velocity;
  std::vector<SE3> poses = {previous.T_reference_mid * SE3::exp(motion + 0.5 * dt * dt * acceleration)};
  for (const double factor : {0.5, 0.0, 2.0, -1.0}) {
    poses.push_back(previous.T_reference_mid * SE3::exp(factor * motion));
  }
  return poses;
}

Vector6 MotionPrior::expectedXi(const SE3& T_reference_mid, double exposure) const {
  const Vector6 mean_velocity = (previous.T_reference_mid.inverse() * T_reference_mid).log() / dt;
  return exposure * (2.0 * mean_velocity - previous.velocity);
}

Vector6 MotionPrior::bend(const SE3& T_reference_mid, const Vector6& xi, double exposure) const {
  const Vector6 mean_velocity = (previous.T_reference_mid.inverse() * T_reference_mid).log() / dt;
  return 2.0 * exposure / dt * (xi - exposure * mean_velocity);
}

Vector6 MotionPrior::poseInformation(const MotionPriorConfig& config, double median_depth) const {
  const double half_dt2 = 0.5 * dt * dt;
  return informationOf(half_dt2 * config.linear_acceleration * median_depth, half_dt2 * config.angular_acceleration);
}

Vector6 MotionPrior::xiInformation(const MotionPriorConfig& config, double median_depth, double exposure) const {
  const double factor = 0.5 * dt * exposure;
  return informationOf(factor * config.linear_acceleration * median_depth, factor * config.angular_acceleration);
}

}  // namespace mba_vo
