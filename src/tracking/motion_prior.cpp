#include "mba_vo/tracking/motion_prior.h"

namespace mba_vo {
namespace {

Vector6 informationOf(double translation_sigma, double rotation_sigma, const Vector6& doubt = Vector6::Zero()) {
  Vector6 variance = doubt.cwiseAbs2();
  variance.head<3>().array() += translation_sigma * translation_sigma;
  variance.tail<3>().array() += rotation_sigma * rotation_sigma;
  return variance.cwiseInverse();
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

Vector6 MotionPrior::xiInformation(const MotionPriorConfig& config, double median_depth, double exposure,
                                   const Vector6& doubt) const {
  const double factor = 0.5 * dt * exposure;
  return informationOf(factor * config.linear_acceleration * median_depth, factor * config.angular_acceleration, doubt);
}

}  // namespace mba_vo
