#pragma once

#include <cmath>
#include <memory>

#include "mba_vo/trajectory/odometry_covariance.h"

namespace mba_vo::test {

inline constexpr double kInterval = 0.04;  // between images [s]
inline constexpr double kNoiseShare = 0.5;
inline constexpr double kModelError = 0.1;      // [px]
inline constexpr double kKeyframeShare = 0.02;  // of old keyframes
inline constexpr double kCorrectionShare = 0.06;
inline constexpr double kFirstScale = 0.006;
inline constexpr double kScaleDrift = 0.0003;  // per keyframe

inline Vector6 vector6(double x, double y, double z, double a, double b, double c) {
  return (Vector6() << x, y, z, a, b, c).finished();
}

/// Of an alignment: position and rotation are known worst together.
inline Matrix6 alignment() {
  Matrix6 root = 1e-3 * Matrix6::Identity();
  root(0, 4) = 2e-3;
  root(3, 1) = -1e-3;
  root(5, 2) = 5e-4;
  return root * root.transpose();
}

inline TrackedFrame trackedAt(int image, MapId map, KeyframeId keyframe) {
  auto frame = std::make_shared<Frame>();
  frame->mid_exposure_ns = std::llround(1e9 * kInterval * image);
  frame->exposure = 0.02;
  frame->pyramid = ImagePyramid(cv::Mat1f(60, 80, 100.0F), PinholeCamera{80, 60, 60.0, 60.0, 39.5, 29.5}, 1);
  TrackedFrame tracked;
  tracked.frame = frame;
  tracked.status = TrackingStatus::kTracking;
  tracked.reference = {map, keyframe, 0};
  tracked.trajectory.exposure = 0.02;
  tracked.trajectory.velocity = vector6(0.3, 0.0, 0.4, 0.0, 1.0, 0.0);
  tracked.covariance.topLeftCorner<6, 6>() = alignment();
  tracked.covariance.bottomRightCorner<6, 6>() = 1e-8 * Matrix6::Identity();
  tracked.expected_error = kModelError * std::sqrt(1.0 - kNoiseShare);  // so that the covariance counts as it is
  return tracked;
}

/// By the alignment, and published with a tenth of its variance.
inline VelocityEstimate velocityOf(const TrackedFrame& tracked) {
  VelocityEstimate velocity;
  velocity.motion = tracked.trajectory.motion();
  velocity.covariance_by_alignment = tracked.covariance.bottomRightCorner<6, 6>() / (0.02 * 0.02);
  velocity.covariance = 0.1 * velocity.covariance_by_alignment;
  return velocity;
}

/// The covariance of odometry whose velocities are those of the blur.
class FollowedOdometry {
 public:
  MotionCovariance update(const TrackedFrame& tracked, const SE3& T_odom_camera, const SE3& T_map_odom) {
    if (tracked.tracked()) velocity_ = velocityOf(tracked);
    return covariance_.update(tracked, velocity_, T_odom_camera, T_map_odom);
  }
  void reset() { covariance_.reset(); }

 private:
  VelocityEstimate velocity_;
  OdometryCovariance covariance_;
};

inline TrackedFrame lostAt(int image) {
  TrackedFrame tracked = trackedAt(image, 0, 0);
  tracked.status = TrackingStatus::kLost;
  return tracked;
}

inline TrackedFrame turnedAt(int image) {
  TrackedFrame tracked = trackedAt(image, 0, 0);
  tracked.status = TrackingStatus::kInitializing;
  tracked.orientation_only = true;
  tracked.covariance.diagonal().head<3>().setConstant(1e6);
  return tracked;
}

inline Matrix6 seenThrough(const SE3& T, const Matrix6& P) { return T.adjoint() * P * T.adjoint().transpose(); }

inline double relativeDifference(const Matrix6& actual, const Matrix6& expected) {
  return (actual - expected).norm() / expected.norm();
}

}  // namespace mba_vo::test
