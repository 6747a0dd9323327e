// Plays a bag to both nodelets, which deblur all the keyframes they can.
#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "demo_sequence.h"
#include "live_odometry.h"
#include "mba_vo/ros/conversions.h"

namespace mba_vo::deblurring_test {
namespace {

constexpr double kRate = 0.5;      // slower than the camera: the test shall also pass on a busy machine
constexpr double kTimeout = 60.0;  // [s]

std::uint64_t accountedFor(const MapperStatus& s) {
  return s.deblur_waiting + s.deblur_sharpened + s.deblur_unsuited + s.deblur_passed_over + s.deblur_too_slow +
         s.deblur_forgotten;
}

TEST(Deblurring, SharpKeyframesArePublishedAndEveryOneIsAccountedFor) {
  std::string folder;
  ASSERT_TRUE(ros::param::get("/demo_folder", folder));
  const DemoSequence sequence = makeDemoSequence(folder);
  const LiveOdometry odometry("/mba_vo", "/camera");
  ASSERT_TRUE(playBag(sequence.bag, kRate));
  ASSERT_TRUE(odometry.waitUntilDone(sequence.stamps.size(), kTimeout));
  const auto isTold = [](const Outputs& outputs) {  // once a second
    return outputs.mapper_status.back()->deblur_sharpened == outputs.keyframe_sharp.size() &&
           !outputs.keyframe_sharp.empty();
  };
  ASSERT_TRUE(odometry.waitFor(isTold, kTimeout));
  const Outputs outputs = odometry.outputs();
  const MapperStatus& status = *outputs.mapper_status.back();
  EXPECT_TRUE(status.phase == "mapping" || status.phase == "refining") << status.phase;
  EXPECT_GE(status.deblur_offered, status.keyframes) << "and the first one of the map";
  EXPECT_EQ(accountedFor(status), status.deblur_offered);
  EXPECT_LE(status.deblur_in_map, status.deblur_sharpened);
  for (const sensor_msgs::ImageConstPtr& image : outputs.keyframe_sharp) {
    EXPECT_EQ(image->encoding, "mono8");
    EXPECT_EQ(image->width, 376U);
    EXPECT_EQ(image->header.frame_id, "camera_optical");
    EXPECT_EQ(std::count(sequence.stamps.begin(), sequence.stamps.end(), toNanoseconds(image->header.stamp)), 1);
  }
}

}  // namespace
}  // namespace mba_vo::deblurring_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "deblurring_test");
  ros::AsyncSpinner spinner(1);
  spinner.start();
  return RUN_ALL_TESTS();
}
