#include "mba_vo/simulation/spline_motion.h"

#include <gtest/gtest.h>

#include "simulation/motion_files.h"

namespace mba_vo::spline_motion_test {
namespace {

using test::motionText;
using test::TemporaryFile;

const char kPose[] = " 1 2 3 0 0 0 1\n";

std::string messageOf(const std::string& content) {
  const TemporaryFile file(content);
  try {
    readMotionFile(file.name());
  } catch (const std::runtime_error& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find(file.name()), 0U) << message;
    return message.substr(file.name().size());
  }
  return "accepted";
}

TEST(MotionFile, ReadsPosesAndSkipsComments) {
  const TemporaryFile file("# t tx ...\n0.5 1 2 3 0 0 0.28 0.96  # the first\r\n\n0.51" + std::string(kPose) + "0.52" +
                           kPose + "0.53" + kPose);
  const std::vector<TimedPose> poses = readMotionFile(file.name());
  ASSERT_EQ(poses.size(), 4U);
  EXPECT_EQ(poses[0].t, 0.5);
  EXPECT_EQ(poses[0].T_world_camera.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(poses[0].T_world_camera.rotation().z(), 0.28, 1e-12);
  EXPECT_NEAR(poses[0].T_world_camera.rotation().w(), 0.96, 1e-12);
}

TEST(MotionFile, SaysWhatIsWrongAndWhere) {
  const std::string two = "0.00" + std::string(kPose) + "0.01" + kPose;
  const std::pair<std::string, std::string> cases[] = {
      {two + "0.02 1 2 3 0 0 1\n", ":3: '0.02 1 2 3 0 0 1' is not t tx ty tz"},
      {two + "0.02 1 2 nan 0 0 0 1\n", ":3: '0.02 1 2 nan"},
      {two + "0.02 1 2 3 0 0 0 1 9\n", ":3: '9' follows"},
      {"# one\n" + two + "0.01" + kPose, ":4: time 0.010000 s does not follow 0.010000 s"},
      {two + "0.30" + kPose, ":3: no pose for 0.29"},
      {two + "0.02 1 2 3 0 0 0 1.1\n", ":3: the quaternion's length is 1.1"},
      {two + "0.02 1 2 3 0 0 0.6 0.8\n", ":3: the camera turns by 73.7"},
      {two, ": 2 poses"},
  };
  for (const auto& [content, expected] : cases) {
    const std::string message = messageOf(content);
    EXPECT_EQ(message.find(expected), 0U) << message;
  }
  EXPECT_THROW(readMotionFile("/nonexistent/motion.txt"), std::runtime_error);
}

/// 100 Hz samples of a violent motion, with quaternions of either sign.
std::vector<TimedPose> samples(const HandHeldMotion& motion, double duration) {
  std::vector<TimedPose> poses;
  for (int i = 0; 0.01 * i <= duration; ++i) {
    const SE3 pose = motion.pose(0.01 * i);
    Eigen::Quaterniond q = pose.rotation();
    if (i % 3 == 0) q.coeffs() = -q.coeffs();
    poses.push_back({7.0 + 0.01 * i, SE3(q, pose.translation())});
  }
  return poses;
}

TEST(SplineMotion, FollowsTheSamplesAndTheMotionBetween) {
  const HandHeldMotion motion({3, 6.0, 2.0, 6.0}, FreeSpace{});
  const std::vector<TimedPose> poses = samples(motion, 6.0);
  const SplineMotion spline(poses);
  for (const TimedPose& pose : poses) {
    EXPECT_LT((spline.pose(pose.t).inverse() * pose.T_world_camera).log().norm(), 1e-9);
  }
  double worst_place = 0.0;
  double worst_turn = 0.0;
  double moved = 0.0;
  for (double t = 0.1; t < 5.9; t += 0.00173) {
    const Vector6 error = (motion.pose(t).inverse() * spline.pose(7.0 + t)).log();
    worst_place = std::max(worst_place, error.head<3>().norm());
    worst_turn = std::max(worst_turn, error.tail<3>().norm());
    moved = std::max(moved, (motion.pose(t).inverse() * motion.pose(t + 0.01)).log().tail<3>().norm());
  }
  EXPECT_GT(moved, 0.02);  // [rad] from sample to sample
  EXPECT_LT(worst_place, 1e-6);
  EXPECT_LT(worst_turn, 5e-6);
}

TEST(SplineMotion, VelocityIsContinuousAtThePoses) {
  const HandHeldMotion motion({3, 4.0, 2.0, 0.0}, FreeSpace{});
  const SplineMotion spline(samples(motion, 4.0));
  const double h = 1e-4;
  const auto velocity = [&](double t) -> Vector6 {
    return (spline.pose(t - h).inverse() * spline.pose(t + h)).log() / (2.0 * h);
  };
  for (int i = 10; i < 390; i += 7) {
    const double knot = 7.0 + 0.01 * i;
    const Vector6 jump = velocity(knot + 2.0 * h) - velocity(knot - 2.0 * h);
    const Vector6 there = (motion.pose(0.01 * i - 0.002).inverse() * motion.pose(0.01 * i + 0.002)).log() / 0.004;
    const Vector6 before = (motion.pose(0.01 * i - 0.004).inverse() * motion.pose(0.01 * i)).log() / 0.004;
    const Vector6 acceleration = (there - before) / 0.002;
    // What the motion's own acceleration explains, and a little.
    EXPECT_LT((jump - 4.0 * h * acceleration).norm(), 0.004) << knot;
  }
}

TEST(SplineMotion, StepsMayBeUneven) {
  const HandHeldMotion motion({5, 3.0, 1.0, 0.0}, FreeSpace{});
  std::vector<TimedPose> poses;
  for (double t = 0.0; t < 3.0; t += 0.008 + 0.006 * std::abs(std::sin(40.0 * t))) poses.push_back({t, motion.pose(t)});
  const SplineMotion spline(poses);
  for (double t = 0.1; t < 2.9; t += 0.0031) {
    EXPECT_LT((motion.pose(t).inverse() * spline.pose(t)).log().norm(), 1e-5) << t;
  }
}

TEST(SplineMotion, StandsStillOutside) {
  const SplineMotion spline(samples(HandHeldMotion({3, 1.0, 1.0, 0.0}, FreeSpace{}), 1.0));
  EXPECT_EQ((spline.pose(spline.begin()).inverse() * spline.pose(-5.0)).log().norm(), 0.0);
  EXPECT_EQ((spline.pose(spline.end()).inverse() * spline.pose(99.0)).log().norm(), 0.0);
}

}  // namespace
}  // namespace mba_vo::spline_motion_test
