// Where the camera is on its base is asked of TF, which may know it, know it later, or know nothing.
#include <geometry_msgs/TransformStamped.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include "robot.h"

namespace mba_vo::extrinsic_test {
namespace {

constexpr std::size_t kUntilMap = 25;     // images that are enough for a map, and some more
constexpr double kLongestWait = 20.0;     // [s]
constexpr double kMuchLess = 8.0;         // [s] than the longest wait, of which Robot::see() may take 6
constexpr double kUntilNothingComes = 1;  // [s] of a TF that knows neither frame nothing is expected by then

geometry_msgs::TransformStamped transform(const std::string& parent, const std::string& child, double x) {
  geometry_msgs::TransformStamped message;
  message.header.frame_id = parent;
  message.child_frame_id = child;
  message.transform.translation.x = x;
  message.transform.rotation.w = 1.0;
  return message;
}

bool hasPose(const Outputs& outputs) { return !outputs.pose.empty(); }

TEST(Extrinsic, ATfThatKnowsNeitherFrameIsNotWaitedFor) {
  Robot robot("untold", nullptr, "raw", kLongestWait);
  ros::WallDuration(kLongestWait).sleep();  // in which it could have told
  robot.see(0, kUntilMap / 2);
  EXPECT_TRUE(robot.odometry->waitFor(hasPose, kMuchLess));
}

TEST(Extrinsic, ATfThatKnowsTheBaseIsWaitedFor) {
  constexpr double kAhead = 0.7;  // [m]
  tf2_ros::StaticTransformBroadcaster tf;
  tf.sendTransform(transform("told_base", "told_wheel", 0.0));
  Robot robot("told", nullptr, "raw", kLongestWait);
  ros::WallDuration(kLongestWait).sleep();
  robot.see(0, 2);
  ros::WallDuration(kUntilNothingComes).sleep();
  robot.see(2, 4);
  tf.sendTransform(transform("told_base", "camera_optical", kAhead));
  robot.see(4, kUntilMap);
  ASSERT_TRUE(robot.odometry->waitFor(hasPose, kMuchLess));
  const Outputs outputs = robot.odometry->outputs();
  EXPECT_EQ(outputs.tracked_frame.back()->message.mount.T_base_camera.translation().x(), kAhead);
}

}  // namespace
}  // namespace mba_vo::extrinsic_test
