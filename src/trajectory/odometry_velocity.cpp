#include "mba_vo/trajectory/odometry_velocity.h"

#include <algorithm>

#include "mba_vo/tracking/motion_state.h"
#include "mba_vo/trajectory/alignment_covariance.h"

namespace mba_vo {
namespace {

constexpr double kMemory = 2.0;              // [s] of the accelerations
constexpr double kUnmeasuredVariance = 1e6;  // [m^2/s^2, rad^2/s^2]
constexpr double kPredictedLag = 1.5;        // [frame intervals] of a velocity that was predicted, see MotionState
constexpr double kUnknownExposureSigma = 1;  // of the log of an exposure that nobody told

// What adds to the noise of an alignment over the interval: that makes errors of recorded motions and of seeds 300 to
// 319 of scripts/covariance.py likeliest, rounded (docs/decisions/2026-11-28-published-velocities.md).
constexpr double kLag = 0.2;            // [frame intervals] by which the acceleration of late is missed
constexpr double kUntoldTurnLag = 0.4;  // the same, of turns that neither blur nor rows tell
constexpr double kBlurShare = 0.12;     // of the variance of a turn by its blur

}  // namespace

Matrix6 unmeasuredVelocity() { return kUnmeasuredVariance * Matrix6::Identity(); }

void OdometryVelocity::add(const TrackedFrame& tracked, const SE3& T_odom_camera) {
  const std::int64_t now = tracked.frame->mid_exposure_ns;
  if (map_id_ != tracked.reference.map_id) {
    *this = OdometryVelocity();  // its unit of length is another
    map_id_ = tracked.reference.map_id;
  } else if (now <= last_ns_) {
    return;
  }
  const double seconds = frames_ > 0 ? 1e-9 * static_cast<double>(now - last_ns_) : 0.0;
  by_poses_.add(now, T_odom_camera, observedMotion(tracked));
  const BodyMotion motion = by_poses_.knowsBefore() ? by_poses_.bestOfLast() : tracked.trajectory.motion();
  ++frames_;
  observeAcceleration(motion.velocity, seconds);
  last_.motion = motion;
  last_.covariance_by_alignment = covarianceByAlignment(tracked, seconds);
  last_.covariance = covarianceOf(tracked, seconds);
  last_ns_ = now;
}

void OdometryVelocity::observeAcceleration(const Vector6& velocity, double seconds) {
  if (frames_ < 2 || !(seconds > 0.0) || !(seconds < kLongestPrediction)) return;
  const Vector6 acceleration = (velocity - last_.motion.velocity) / seconds;
  const double share = std::max(1.0 / static_cast<double>(frames_ - 1), std::min(1.0, seconds / kMemory));
  last_.linear_acceleration += share * (acceleration.head<3>().squaredNorm() / 3.0 - last_.linear_acceleration);
  last_.angular_acceleration += share * (acceleration.tail<3>().squaredNorm() / 3.0 - last_.angular_acceleration);
}

Matrix6 OdometryVelocity::covarianceByAlignment(const TrackedFrame& tracked, double seconds) const {
  const ExposureTrajectory& motion = tracked.trajectory;
  const Matrix12 alignment = alignmentCovariance(tracked);
  if (motion.exposure > 0.0) {
    // Where the blur says little, the motion since the last frame does: the prior of the alignment is in it.
    const ExposureEstimate& estimate = tracked.exposure_estimate;
    const bool told = tracked.frame->exposure && !estimate.used;
    const Vector6 unknown = (told ? 0.0 : std::min(estimate.log_sigma, kUnknownExposureSigma)) * motion.velocity;
    return alignment.bottomRightCorner<6, 6>() / (motion.exposure * motion.exposure) + unknown * unknown.transpose();
  }
  if (frames_ < 3 || !(seconds > 0.0)) return unmeasuredVelocity();
  // The difference of two poses that were measured alike, and what the velocity has changed by since.
  Matrix6 covariance = 2.0 / (seconds * seconds) * alignment.topLeftCorner<6, 6>();
  const double lag = kPredictedLag * seconds;
  covariance.diagonal().head<3>().array() += lag * lag * last_.linear_acceleration;
  covariance.diagonal().tail<3>().array() += lag * lag * last_.angular_acceleration;
  return covariance;
}

Matrix6 OdometryVelocity::covarianceOf(const TrackedFrame& tracked, double seconds) const {
  const Matrix6& by_blur = last_.covariance_by_alignment;
  if (!by_poses_.knowsBefore()) return by_blur;
  Matrix6 covariance = alignmentCovariance(tracked).topLeftCorner<6, 6>() / (seconds * seconds);
  const auto measured = observedMotion(tracked);
  const double way_lag = kLag * seconds;
  const double turn_lag = (measured ? kLag : kUntoldTurnLag) * seconds;
  covariance.diagonal().head<3>().array() += way_lag * way_lag * last_.linear_acceleration;
  covariance.diagonal().tail<3>().array() += turn_lag * turn_lag * last_.angular_acceleration;
  if (measured) covariance.bottomRightCorner<3, 3>() += kBlurShare * by_blur.bottomRightCorner<3, 3>();
  if (!measured || !measured->angular_acceleration) return covariance;
  covariance.topRightCorner<3, 3>().setZero();
  covariance.bottomLeftCorner<3, 3>().setZero();
  covariance.bottomRightCorner<3, 3>() = by_blur.bottomRightCorner<3, 3>();
  return covariance;
}

}  // namespace mba_vo
