#include "mba_vo/ros/motion_messages.h"

#include <cmath>

#include <gtest/gtest.h>

#include "mba_vo/ros/conversions.h"

namespace mba_vo::motion_messages_test {
namespace {

SE3 pose(double x, double y, double z, double a, double b, double c) {
  return SE3(Eigen::AngleAxisd(a, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(b, Eigen::Vector3d::UnitY()) *
                 Eigen::AngleAxisd(c, Eigen::Vector3d::UnitZ()),
             Eigen::Vector3d(x, y, z));
}

MeasuredMotion testMotion() {
  auto frame = std::make_shared<Frame>();
  frame->stamp_ns = 5'000'000'000;
  frame->mid_exposure_ns = 5'010'000'000;
  frame->exposure = 0.02;
  auto tracked = std::make_shared<TrackedFrame>();
  tracked->frame = frame;
  tracked->status = TrackingStatus::kTracking;
  tracked->trajectory.T_reference_mid = pose(0.3, -0.1, 0.2, 0.1, -0.2, 0.3);
  tracked->trajectory.velocity << 0.4, -0.3, 1.1, 0.9, 0.0, -0.5;  // by its blur, and not what is published
  tracked->trajectory.exposure = 0.02;
  tracked->covariance.setIdentity();
  tracked->covariance *= 1e-6;
  tracked->xi_prior_limited = false;
  MeasuredMotion motion;
  motion.tracked = tracked;
  motion.T_odom_camera = pose(1.0, 2.0, 3.0, -0.4, 0.2, 0.5);
  motion.motion.velocity << 0.5, -0.2, 1.0, 0.8, 0.1, -0.6;
  motion.T_map_odom = pose(0.1, 0.2, 0.3, 0.05, 0.0, -0.1);
  motion.T_base_camera = pose(0.2, -0.1, 0.4, -1.5, 0.1, -1.6);
  motion.camera_frame = "camera";
  motion.covariance.odom = 4e-4 * Matrix6::Identity();
  motion.covariance.map = 1e-4 * Matrix6::Identity();
  motion.covariance.velocity = 9e-4 * Matrix6::Identity();
  return motion;
}

/// What a geometry_msgs covariance is about: displacement of the position and rotation about the parent's fixed axes.
Vector6 rosDifference(const SE3& T, const SE3& T_disturbed) {
  Vector6 difference;
  difference.head<3>() = T_disturbed.translation() - T.translation();
  const Eigen::AngleAxisd rotation(T_disturbed.rotation() * T.rotation().inverse());
  difference.tail<3>() = rotation.angle() * rotation.axis();
  return difference;
}

TEST(MotionMessages, PoseCovarianceIsThatOfTheDisturbedPose) {
  const MeasuredMotion motion = testMotion();
  const SE3 T_world_base = toBaseWorld(motion.T_odom_camera, motion.T_base_camera);
  Matrix6 J;  // of the base pose by the camera's right increment, by central differences
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 6; ++i) {
    const Vector6 step = kStep * Vector6::Unit(i);
    const SE3 plus = toBaseWorld(motion.T_odom_camera * SE3::exp(step), motion.T_base_camera);
    const SE3 minus = toBaseWorld(motion.T_odom_camera * SE3::exp(-step), motion.T_base_camera);
    J.col(i) = (rosDifference(T_world_base, plus) - rosDifference(T_world_base, minus)) / (2.0 * kStep);
  }
  Matrix6 increment = Matrix6::Zero();
  increment.diagonal() << 1.0, 2.0, 3.0, 0.1, 0.2, 0.3;
  increment(0, 4) = increment(4, 0) = 0.2;
  const Matrix6 expected = J * increment * J.transpose();
  const Matrix6 actual = poseCovariance(increment, motion.T_base_camera, T_world_base);
  EXPECT_LT((actual - expected).norm(), 1e-6 * expected.norm());
}

TEST(MotionMessages, TwistIsThatOfTheBase) {
  const MeasuredMotion motion = testMotion();
  const nav_msgs::Odometry odometry = makeOdometry(motion, FrameNames());
  constexpr double kStep = 1e-5;  // [s]
  const auto baseAt = [&](double t) {
    return toBaseWorld(motion.T_odom_camera * SE3::exp(t * motion.motion.velocity), motion.T_base_camera);
  };
  const Vector6 velocity = (baseAt(-kStep).inverse() * baseAt(kStep)).log() / (2.0 * kStep);
  EXPECT_NEAR(odometry.twist.twist.linear.x, velocity[0], 1e-6);
  EXPECT_NEAR(odometry.twist.twist.linear.z, velocity[2], 1e-6);
  EXPECT_NEAR(odometry.twist.twist.angular.y, velocity[4], 1e-6);
  EXPECT_EQ(odometry.child_frame_id, "base_link");
  EXPECT_EQ(odometry.header.frame_id, "odom");
  EXPECT_EQ(toNanoseconds(odometry.header.stamp), 5'010'000'000);
  EXPECT_GT(odometry.pose.covariance[0], 0.0);
  EXPECT_GT(odometry.twist.covariance[35], 0.0);
}

TEST(MotionMessages, ExposureMotionCarriesBothTimesAndBothEnds) {
  const MeasuredMotion motion = testMotion();
  const ExposureMotion message = makeExposureMotion(motion, FrameNames());
  EXPECT_EQ(toNanoseconds(message.header.stamp), 5'000'000'000);
  EXPECT_EQ(toNanoseconds(message.mid_time), 5'010'000'000);
  EXPECT_DOUBLE_EQ(message.exposure_time, 0.02);
  EXPECT_EQ(message.child_frame_id, "camera");
  // Camera in odom, whose axes and origin are those that the base had when the camera was at its own origin.
  const SE3 T_start = motion.T_base_camera * motion.T_odom_camera * SE3::exp(-0.01 * motion.motion.velocity);
  EXPECT_NEAR(message.start.position.x, T_start.translation().x(), 1e-12);
  EXPECT_NEAR(message.start.position.z, T_start.translation().z(), 1e-12);
  const SE3 T_end = motion.T_base_camera * motion.T_odom_camera * SE3::exp(0.01 * motion.motion.velocity);
  EXPECT_NEAR(message.end.position.y, T_end.translation().y(), 1e-12);
  EXPECT_NEAR(std::abs(message.end.orientation.w), std::abs(T_end.rotation().w()), 1e-12);
}

TEST(MotionMessages, PoseIsOdometryMovedByMapToOdom) {
  const MeasuredMotion motion = testMotion();
  const auto message = makePose(motion, FrameNames());
  const SE3 T_map_base =
      toBaseWorld(motion.T_map_odom, motion.T_base_camera) * toBaseWorld(motion.T_odom_camera, motion.T_base_camera);
  EXPECT_EQ(message.header.frame_id, "map");
  EXPECT_NEAR(message.pose.pose.position.x, T_map_base.translation().x(), 1e-12);
  EXPECT_NEAR(message.pose.pose.position.y, T_map_base.translation().y(), 1e-12);
}

TEST(MotionMessages, ConfidenceGrowsWithTheBlurOverItsUncertainty) {
  MeasuredMotion motion = testMotion();
  auto tracked = std::make_shared<TrackedFrame>(*motion.tracked);
  const double squared_length = tracked->trajectory.xi().squaredNorm() / 1e-6;
  EXPECT_NEAR(motionConfidence(*tracked), 1.0 - 6.0 / squared_length, 1e-9);
  tracked->covariance *= 1e4;  // motion drowns in noise
  EXPECT_EQ(motionConfidence(*tracked), 0.0);
  tracked->covariance *= 1e-8;
  EXPECT_GT(motionConfidence(*tracked), 0.99);
  tracked->xi_prior_limited = true;
  EXPECT_EQ(motionConfidence(*tracked), 0.0);
}

TEST(MotionMessages, EachMessageHasItsOwnCovariance) {
  MeasuredMotion motion = testMotion();
  motion.T_base_camera = SE3();  // then the variance of x in the base is that of the camera's x, turned
  motion.T_odom_camera = SE3();
  motion.T_map_odom = SE3();
  const nav_msgs::Odometry odometry = makeOdometry(motion, FrameNames());
  const auto pose = makePose(motion, FrameNames());
  EXPECT_NEAR(odometry.pose.covariance[0], 4e-4, 1e-12);
  EXPECT_NEAR(pose.pose.covariance[0], 1e-4, 1e-12);
  EXPECT_NEAR(odometry.twist.covariance[0], 9e-4, 1e-12);
}

}  // namespace
}  // namespace mba_vo::motion_messages_test
