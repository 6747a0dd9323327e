#include "mba_vo/odometry/dead_reckoning.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "mba_vo/tracking/motion_state.h"
#include "mba_vo/trajectory/alignment_covariance.h"

namespace mba_vo {
namespace {

/// [m^2/s^2], summed over the axes.
double velocityVariance(const TrackedFrame& tracked, double interval) {
  const Matrix12 covariance = alignmentCovariance(tracked);
  const double exposure = tracked.trajectory.exposure;
  if (exposure > 0.0 && !tracked.xi_prior_limited)
    return covariance.diagonal().segment<3>(6).sum() / (exposure * exposure);
  if (interval > 0.0) return 2.0 * covariance.diagonal().head<3>().sum() / (interval * interval);
  return std::numeric_limits<double>::infinity();
}

/// An estimate that is shrunk towards zero by what is likely to be error in it (James and Stein, 1961): a velocity that
/// is not known leads further astray than none.
Eigen::Vector3d knownPart(const Eigen::Vector3d& velocity, double variance) {
  const double squared = velocity.squaredNorm();
  return squared > variance ? Eigen::Vector3d((1.0 - variance / squared) * velocity) : Eigen::Vector3d::Zero();
}

/// Of a camera that moves by `way`, in its own axes, past a scene at `depth`.
Eigen::Quaterniond turnThatItSeems(const Eigen::Vector3d& way, double depth) {
  if (!(depth > 0.0)) return Eigen::Quaterniond::Identity();
  Vector6 turn;
  turn << 0.0, 0.0, 0.0, -way.y() / depth, way.x() / depth, 0.0;
  return SE3::exp(turn).rotation();
}

}  // namespace

void DeadReckoning::beginAt(const TrackedFrame& tracked, const SE3& T_odom_camera, double depth) {
  const Vector6& velocity = tracked.trajectory.velocity;
  const double interval = first_ ? tracked.frame->midExposureSeconds() - first_->midExposureSeconds() : 0.0;
  const double variance = velocityVariance(tracked, interval);
  velocity_odom_ = T_odom_camera.rotationMatrix() * knownPart(velocity.head<3>(), variance);
  velocity_variance_ = std::min(variance, velocity.head<3>().squaredNorm());
  first_ = tracked.frame;
  depth_ = depth;
  T_odom_first_ = T_odom_camera;
  poses_ = {{first_->mid_exposure_ns, T_odom_camera, true, velocity.tail<3>()}};
}

bool DeadReckoning::track(const FrameConstPtr& frame) {
  if (poses_.size() == 1) {
    orientation_.reset();
    if (first_) orientation_.begin(first_, poses_.front().angular_velocity);
  }
  const bool measured = orientation_.track(frame);
  const double seconds = first_ ? frame->midExposureSeconds() - first_->midExposureSeconds() : 0.0;
  const Eigen::Vector3d way = std::clamp(seconds, 0.0, kLongestPrediction) * velocity_odom_;
  const ExposureTrajectory turn = orientation_.last();
  const Eigen::Quaterniond R_odom_camera = T_odom_first_.rotation() * turn.T_reference_mid.rotation();
  const SE3 T_odom_camera(R_odom_camera * turnThatItSeems(R_odom_camera.conjugate() * way, depth_).conjugate(),
                          T_odom_first_.translation() + way);
  poses_.push_back({frame->mid_exposure_ns, T_odom_camera, measured, turn.velocity.tail<3>()});
  const auto oldest_ns = frame->mid_exposure_ns - std::llround(1e9 * memory_);
  while (poses_.size() > 2 && poses_.front().mid_exposure_ns < oldest_ns) poses_.pop_front();
  return measured;
}

std::optional<CameraTurn> DeadReckoning::turnBetween(std::int64_t from_ns, std::int64_t to_ns) const {
  const auto isOf = [](std::int64_t ns) { return [ns](const Pose& pose) { return pose.mid_exposure_ns == ns; }; };
  const auto from = std::find_if(poses_.begin(), poses_.end(), isOf(from_ns));
  const auto to = std::find_if(from, poses_.end(), isOf(to_ns));
  if (from == to || to == poses_.end()) return std::nullopt;
  if (!std::all_of(std::next(from), std::next(to), [](const Pose& pose) { return pose.turn_measured; }))
    return std::nullopt;
  const Eigen::Quaterniond R_from_to = from->T_odom_camera.rotation().conjugate() * to->T_odom_camera.rotation();
  return CameraTurn{R_from_to, to->angular_velocity};
}

const SE3& DeadReckoning::T_odom_cameraAt(std::int64_t mid_exposure_ns) const {
  const auto isAfter = [](std::int64_t then, const Pose& pose) { return then < pose.mid_exposure_ns; };
  const auto after = std::upper_bound(poses_.begin(), poses_.end(), mid_exposure_ns, isAfter);
  return after == poses_.begin() ? poses_.front().T_odom_camera : std::prev(after)->T_odom_camera;
}

double DeadReckoning::positionSigma() const {
  if (!first_ || !(depth_ > 0.0)) return std::numeric_limits<double>::infinity();
  const double seconds = 1e-9 * static_cast<double>(poses_.back().mid_exposure_ns - first_->mid_exposure_ns);
  const double predicted = std::min(seconds, kLongestPrediction);
  const double bend = predicted * (seconds - 0.5 * predicted) * acceleration_;  // it goes on as fast as it is by then
  return std::sqrt(bend * bend + seconds * seconds * velocity_variance_ / (depth_ * depth_));
}

Eigen::Matrix3d DeadReckoning::covariance() const {
  Eigen::Matrix3d covariance = orientation_.covariance();
  const double sigma = positionSigma();
  if (std::isfinite(sigma)) covariance.diagonal().head<2>().array() += sigma * sigma;
  return covariance;
}

Vector6 DeadReckoning::velocity() const {
  Vector6 velocity;
  velocity << T_odom_camera().rotationMatrix().transpose() * velocity_odom_, poses_.back().angular_velocity;
  return velocity;
}

void DeadReckoning::reset() {
  orientation_.reset();
  first_.reset();
  T_odom_first_ = SE3();
  velocity_odom_.setZero();
  poses_ = {Pose()};
}

}  // namespace mba_vo
