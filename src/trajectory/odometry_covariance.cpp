#include "mba_vo/trajectory/odometry_covariance.h"

#include <algorithm>
#include <cmath>

#include "mba_vo/tracking/motion_state.h"
#include "mba_vo/trajectory/alignment_covariance.h"

namespace mba_vo {
namespace {

// Those that make the errors of all published poses likeliest (the greatest mean log of their normal density),
// together, over the sequences of scripts/covariance.py: seeds 200 to 222 with --live and 200 to 219 without. The drift
// of the scale is a judgement between these and a walk of 20 m: 12 s tell little of it.
constexpr double kKeyframeShare = 0.02;    // of a keyframe's variance that remains when the map has been optimised
constexpr double kCorrectionShare = 0.06;  // of the squares of what the map is corrected by
constexpr double kFirstScale = 6e-3;       // standard deviation of the scale that a map begins with
constexpr double kScaleDrift = 3e-4;       // and of its drift with each keyframe

Matrix6 seenThrough(const SE3& T, const Matrix6& covariance) {
  const Matrix6 Ad = T.adjoint();
  return Ad * covariance * Ad.transpose();
}

Matrix6 isotropic(double translation, double rotation) {
  Vector6 diagonal;
  diagonal << Eigen::Vector3d::Constant(translation), Eigen::Vector3d::Constant(rotation);
  return diagonal.asDiagonal();
}

Matrix6 squareOf(const Vector6& error) { return error * error.transpose(); }

}  // namespace

MotionCovariance OdometryCovariance::update(const TrackedFrame& tracked, const VelocityEstimate& velocity,
                                            const SE3& T_odom_camera, const SE3& T_map_odom) {
  if (!tracked.hasPose() && !tracked.orientation_only) {
    lost_ = true;
    return {};
  }
  const std::int64_t now = tracked.frame->mid_exposure_ns;
  const double seconds = last_ ? 1e-9 * static_cast<double>(now - last_->mid_exposure_ns) : 0.0;
  const bool same_map = has_map_ && last_->reference.map_id == tracked.reference.map_id;
  if (has_map_ && !same_map) closeMap(T_odom_camera, seconds);
  const SE3 T_camera_odom = T_odom_camera.inverse();
  if (!tracked.tracked()) return reckoned(tracked, velocity, T_camera_odom, seconds);
  if (has_map_) {
    goOnInMap(tracked, T_odom_camera, T_map_odom);
  } else {
    beginMap(tracked, T_odom_camera, T_map_odom);
  }
  MotionCovariance result;
  const Matrix6 alignment = alignmentCovariance(tracked).topLeftCorner<6, 6>();
  const Vector6 left_behind = (T_camera_odom * T_map_odom_first_.inverse() * T_map_odom * T_odom_camera).log();
  result.map = seenThrough(T_camera_odom, map_ + keyframe_) + scaleErrors(T_odom_camera) + alignment;
  result.odom = result.map + seenThrough(T_camera_odom, before_) + squareOf(left_behind);
  observeSpeed(velocity.motion.velocity);
  result.velocity = velocity.covariance;
  last_ = {tracked.reference, now, T_odom_camera, T_map_odom, alignment, result};
  lost_ = false;
  return result;
}

/// The rotation is measured. Where a map was left a moment ago, the position is predicted from the velocity of then.
MotionCovariance OdometryCovariance::reckoned(const TrackedFrame& tracked, const VelocityEstimate& velocity,
                                              const SE3& T_camera_odom, double seconds) {
  MotionCovariance result;
  result.velocity = unmeasuredVelocity();
  Matrix6 since = tracked.covariance.topLeftCorner<6, 6>();
  if (!has_map_) {
    result.map = since;
    result.odom = seenThrough(T_camera_odom, before_) + since;
    return result;
  }
  lost_ = true;
  since.topLeftCorner<3, 3>() = placeVariance(velocity, seconds) * Eigen::Matrix3d::Identity();
  const SE3 T_camera_last = T_camera_odom * last_->T_odom_camera;
  result.map = seenThrough(T_camera_last, last_->covariance.map) + since;
  result.odom = seenThrough(T_camera_last, last_->covariance.odom) + since;
  if (!tracked.predicted) return result;
  result.velocity =
      velocity.covariance + seconds * seconds * isotropic(velocity.linear_acceleration, velocity.angular_acceleration);
  return result;
}

/// Of each coordinate of a place that many seconds after the last pose [m^2]. A velocity counts as far as it is known,
/// so that the place errs by no more than if the camera had been taken to stand still.
double OdometryCovariance::placeVariance(const VelocityEstimate& velocity, double seconds) const {
  const double predicted = std::min(seconds, kLongestPrediction);
  const double unmeasured = seconds - predicted;
  const double speed = speed_.linear / 3.0;
  const double unknown = std::min(speed, velocity.covariance_by_alignment.diagonal().head<3>().mean());
  return unknown * predicted * predicted + 0.25 * std::pow(predicted, 4) * velocity.linear_acceleration +
         speed * unmeasured * unmeasured;
}

/// All that was gathered stays, and the camera turns unmeasured for so long.
void OdometryCovariance::closeMap(const SE3& T_odom_camera, double seconds) {
  const double turned = speed_.angular * seconds * seconds / 3.0;
  before_ =
      seenThrough(last_->T_odom_camera, last_->covariance.odom) + seenThrough(T_odom_camera, isotropic(0.0, turned));
  has_map_ = false;
}

void OdometryCovariance::beginMap(const TrackedFrame& tracked, const SE3& T_odom_camera, const SE3& T_map_odom) {
  if (last_) {
    const double seconds = 1e-9 * static_cast<double>(tracked.frame->mid_exposure_ns - last_->mid_exposure_ns);
    before_ += seenThrough(T_odom_camera, isotropic(speed_.linear * seconds * seconds / 3.0, 0.0));
  }
  // What ties the map to its first pose stays, for that pose is not measured again.
  map_ = seenThrough(T_odom_camera, alignmentCovariance(tracked).topLeftCorner<6, 6>());
  keyframe_ = Matrix6::Zero();
  scales_ = {};
  changeScale(T_odom_camera.translation(), kFirstScale);
  T_map_odom_first_ = T_map_odom;
  speed_ = {};
  frames_ = 0;
  has_map_ = true;
}

void OdometryCovariance::goOnInMap(const TrackedFrame& tracked, const SE3& T_odom_camera, const SE3& T_map_odom) {
  if (tracked.reference.keyframe_id != last_->reference.keyframe_id) {
    useKeyframe(last_->T_odom_camera, last_->alignment);
  }
  // When a lost camera was found, it is not the map that has moved.
  if (lost_) return;
  const SE3 correction = last_->T_map_odom.inverse() * T_map_odom;
  const Vector6 seen = (T_odom_camera.inverse() * correction * T_odom_camera).log();
  map_ += kCorrectionShare * seenThrough(T_odom_camera, squareOf(seen));
}

void OdometryCovariance::useKeyframe(const SE3& T_odom_camera, const Matrix6& alignment) {
  map_ += kKeyframeShare * keyframe_;
  keyframe_ = seenThrough(T_odom_camera, alignment);
  changeScale(T_odom_camera.translation(), kScaleDrift);
}

void OdometryCovariance::changeScale(const Eigen::Vector3d& place, double sigma) {
  const double variance = sigma * sigma;
  scales_.variance += variance;
  scales_.sum += variance * place;
  scales_.squares += variance * place * place.transpose();
}

/// A wrong scale displaces the camera by its share of the way from where it came in; in the camera's axes.
Matrix6 OdometryCovariance::scaleErrors(const SE3& T_odom_camera) const {
  const Eigen::Vector3d& place = T_odom_camera.translation();
  const Eigen::Matrix3d cross = place * scales_.sum.transpose();
  const Eigen::Matrix3d squares =
      scales_.variance * place * place.transpose() - cross - cross.transpose() + scales_.squares;
  const Eigen::Matrix3d R_camera_odom = T_odom_camera.rotationMatrix().transpose();
  Matrix6 errors = Matrix6::Zero();
  errors.topLeftCorner<3, 3>() = R_camera_odom * squares * R_camera_odom.transpose();
  return errors;
}

void OdometryCovariance::observeSpeed(const Vector6& velocity) {
  const double weight = 1.0 / static_cast<double>(++frames_);
  speed_.linear += weight * (velocity.head<3>().squaredNorm() - speed_.linear);
  speed_.angular += weight * (velocity.tail<3>().squaredNorm() - speed_.angular);
}

}  // namespace mba_vo
