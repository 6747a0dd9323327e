// What happens to nodes in a robot's life: they are reset, killed and started again, bags are looped, paused and played
// at any speed, and a second camera comes into the same process.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "mba_vo/ros/conversions.h"
#include "robot.h"
#include "ros/console_lines.h"

namespace mba_vo::lifecycle_test {
namespace {

constexpr std::size_t kUntilMap = 25;  // images that are enough for a map, and some more

MapId newestMap(const LiveOdometry& odometry) { return odometry.outputs().exposure_motion.back()->map_id; }

/// The maps in the order of the file. The poses of each must be ordered by time.
std::vector<int> mapsOf(const std::string& file) {
  std::vector<int> maps;
  double last = 0.0;
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("# map ", 0) == 0) {
      maps.push_back(std::stoi(line.substr(6)));
      last = 0.0;
    } else if (line[0] != '#') {
      EXPECT_GT(std::stod(line), last) << line;
      last = std::stod(line);
    }
  }
  return maps;
}

TEST(Lifecycle, ACameraThatIsCoveredForAWhileIsFoundAgainAndTheConsoleSaysSo) {
  const ConsoleLines said;
  Robot robot("covered");
  robot.see(0, kUntilMap);
  ASSERT_TRUE(robot.becomesTracking());
  robot.see(kUntilMap, kUntilMap + 2, true);
  EXPECT_EQ(said.count("WARN the camera is lost, and looked for: the image shows nothing"), 1U);
  EXPECT_EQ(said.count("the camera is found again"), 0U);
  robot.see(kUntilMap + 2, kUntilMap + 10);
  ASSERT_TRUE(robot.isDone(kUntilMap + 10));
  ASSERT_TRUE(robot.becomesTracking());
  EXPECT_EQ(said.count("the camera is found again"), 1U);
  EXPECT_EQ(robot.odometry->status().resets, 0U);
}

TEST(Lifecycle, ResetWhileTracking) {
  Robot robot("reset");
  robot.see(0, kUntilMap);
  ASSERT_TRUE(robot.becomesTracking());
  const MapId before = newestMap(*robot.odometry);
  ASSERT_TRUE(robot.odometry->reset());
  robot.see(kUntilMap, 2 * kUntilMap);
  ASSERT_TRUE(robot.isDone(2 * kUntilMap));
  ASSERT_TRUE(robot.becomesTracking());
  EXPECT_EQ(robot.odometry->status().resets, 1U);
  EXPECT_GT(newestMap(*robot.odometry), before);
  ASSERT_TRUE(robot.odometry->saveTrajectory()) << "what was before is kept";
  EXPECT_EQ(mapsOf(robot.file("trajectory.txt")).size(), 2U);
}

TEST(Lifecycle, TrackerThatIsStartedAgainGoesOnInTheMap) {
  Robot robot("tracker");
  robot.see(0, kUntilMap);
  ASSERT_TRUE(robot.isDone(kUntilMap));
  ASSERT_TRUE(robot.becomesTracking());
  const MapId before = newestMap(*robot.odometry);
  robot.odometry->restart("tracking");
  robot.see(kUntilMap, 2 * kUntilMap);
  ASSERT_TRUE(robot.odometry->waitFor(
      [](const Outputs& o) {
        return o.status.back()->frames_in < kUntilMap + 1 && o.status.back()->frames_tracked > 0;
      },
      kTimeout));
  EXPECT_EQ(newestMap(*robot.odometry), before);
  EXPECT_EQ(robot.odometry->status().frames_rejected, 0U);
  ASSERT_TRUE(robot.odometry->saveTrajectory());
  EXPECT_EQ(mapsOf(robot.file("trajectory.txt")).size(), 1U);
}

TEST(Lifecycle, MapperThatIsStartedAgainMakesAnotherMap) {
  Robot robot("mapper");
  robot.see(0, kUntilMap);
  ASSERT_TRUE(robot.isDone(kUntilMap));
  ASSERT_TRUE(robot.becomesTracking());
  const MapId before = newestMap(*robot.odometry);
  const std::size_t motions = robot.odometry->outputs().exposure_motion.size();
  robot.odometry->restart("mapping");
  robot.see(kUntilMap, 2 * kUntilMap);
  ASSERT_TRUE(
      robot.odometry->waitFor([&](const Outputs& o) { return o.exposure_motion.back()->map_id > before; }, kTimeout));
  ASSERT_TRUE(robot.becomesTracking());
  const Outputs outputs = robot.odometry->outputs();
  EXPECT_EQ(outputs.status.back()->resets, 0U);
  EXPECT_EQ(outputs.status.back()->frames_lost, 0U) << "the old map does until there is another";
  EXPECT_GE(outputs.exposure_motion.size() + 2, motions + kUntilMap) << "but for some while the new map begins";
  ASSERT_TRUE(robot.odometry->saveTrajectory());
  EXPECT_EQ(mapsOf(robot.file("trajectory.txt")), std::vector<int>{static_cast<int>(before) + 1});
}

TEST(Lifecycle, MapsOfALoopedBagDoNotMix) {
  Robot robot("loop");
  for (int loop = 0; loop < 2; ++loop) {
    robot.see(0, kUntilMap);
    ASSERT_TRUE(robot.isDone(kUntilMap * static_cast<std::size_t>(loop + 1)));
    ASSERT_TRUE(robot.becomesTracking());
  }
  EXPECT_EQ(robot.odometry->status().resets, 1U);
  EXPECT_EQ(robot.odometry->status().frames_rejected, 0U);
  ASSERT_TRUE(robot.odometry->saveTrajectory());
  for (const char* file : {"trajectory.txt", "exposure_trajectory.txt", "online_trajectory.txt"}) {
    EXPECT_EQ(mapsOf(robot.file(file)), (std::vector<int>{1, 2})) << file;
  }
}

TEST(Lifecycle, ClockThatStandsStillForAWhile) {
  Robot robot("pause");
  robot.see(0, kUntilMap);
  ASSERT_TRUE(robot.isDone(kUntilMap));
  const std::size_t statuses = robot.odometry->outputs().status.size();
  ASSERT_TRUE(robot.odometry->waitFor(
      [&](const Outputs& o) {
        const Status& status = *o.status.back();
        return o.status.size() > statuses + 1 && status.state == Status::WAITING &&
               status.reason.find("no image on") == 0;
      },
      kTimeout))
      << "nothing is said while the clock stands still";
  robot.see(kUntilMap, kUntilMap + 10);
  ASSERT_TRUE(robot.isDone(kUntilMap + 10));
  const Status status = robot.odometry->status();
  EXPECT_TRUE(robot.becomesTracking());
  EXPECT_EQ(status.resets + status.frames_rejected + status.frames_missing + status.frames_lost, 0U);
}

TEST(Lifecycle, BagThatIsPlayedFast) {
  Robot robot("camera");  // of the bag
  robot.odometry = std::make_unique<LiveOdometry>("/fast", "/camera");
  ASSERT_TRUE(playBag(recording().sequence.bag, 3.0));
  ASSERT_TRUE(robot.isDone(recording().images.size())) << robot.odometry->status().frames_in;
  EXPECT_EQ(robot.odometry->status().frames_rejected, 0U);
  EXPECT_EQ(robot.odometry->status().resets, 0U);
}

TEST(Lifecycle, TwoCamerasInOneManager) {
  const auto manager = std::make_shared<nodelet::Loader>(false);
  Robot left("left", manager), right("right", manager);
  constexpr std::size_t kAhead = 20;
  for (std::size_t i = 0; i < kUntilMap; ++i) {
    left.see(i, i + 1);
    right.see(i + kAhead, i + kAhead + 1);
  }
  for (const Robot* robot : {&left, &right}) {
    ASSERT_TRUE(robot->isDone(kUntilMap));
    ASSERT_TRUE(robot->becomesTracking());
    EXPECT_EQ(robot->odometry->status().frames_in, kUntilMap);
  }
  const auto stampsOf = [](const Robot& robot) {
    std::set<std::int64_t> stamps;
    for (const auto& motion : robot.odometry->outputs().exposure_motion) {
      stamps.insert(toNanoseconds(motion->header.stamp));
    }
    return stamps;
  };
  EXPECT_LT(*stampsOf(left).rbegin(), recording().images[kUntilMap].stamp_ns);
  EXPECT_EQ(*stampsOf(right).rbegin(), recording().images[kUntilMap + kAhead - 1].stamp_ns);
  EXPECT_GE(*stampsOf(right).begin(), recording().images[kAhead].stamp_ns);
  for (const geometry_msgs::TransformStamped& transform : left.odometry->outputs().transforms) {
    const std::string side = transform.header.frame_id.substr(0, transform.header.frame_id.find('_'));
    EXPECT_EQ(transform.child_frame_id.rfind(side + "_", 0), 0U) << transform.child_frame_id;
  }
  ASSERT_TRUE(left.odometry->reset());
  ASSERT_TRUE(left.odometry->waitFor([](const Outputs& o) { return o.status.back()->resets == 1; }, kTimeout));
  EXPECT_EQ(right.odometry->status().resets, 0U);
  EXPECT_TRUE(right.becomesTracking());
}

/// Images come one at a time, so both runs do the same in the same order, but for a map that comes an image later on a
/// busy machine.
TEST(Lifecycle, ImagesThatWereCompressedWithoutLossGiveTheTrajectoryOfTheOriginals) {
  std::vector<std::vector<PoseRecord>> trajectories;
  for (const char* transport : {"raw", "compressed"}) {
    Robot robot(std::string("sends_") + transport, nullptr, transport);
    robot.see(0, 2 * kUntilMap);
    ASSERT_TRUE(robot.isDone(2 * kUntilMap));
    ASSERT_TRUE(robot.becomesTracking());
    EXPECT_EQ(robot.odometry->status().frames_rejected, 0U);
    EXPECT_EQ(robot.odometry->status().exposure_source, "topic");
    EXPECT_EQ(robot.odometry->status().image_width, 376U);
    ASSERT_TRUE(robot.odometry->saveTrajectory());
    trajectories.push_back(readPoseFile(robot.file("trajectory.txt")));
  }
  const std::vector<PoseRecord>& raw = trajectories[0];
  const std::vector<PoseRecord>& compressed = trajectories[1];
  ASSERT_EQ(compressed.size(), raw.size());
  ASSERT_GT(raw.size(), kUntilMap);
  double largest = 0.0;
  for (std::size_t i = 0; i < raw.size(); ++i) {
    EXPECT_EQ(compressed[i].time, raw[i].time);
    largest = std::max(largest, (raw[i].T_world_camera.inverse() * compressed[i].T_world_camera).log().norm());
  }
  EXPECT_LT(largest, 1e-3) << "the room is about 1 unit deep";
  RecordProperty("largest_difference", std::to_string(largest));
}

TEST(Lifecycle, NoPoseIsNoSuccess) {
  const Robot robot("idle");
  const std_srvs::TriggerResponse answer = robot.odometry->askForTrajectory();
  EXPECT_FALSE(answer.success);
  EXPECT_NE(answer.message.find("there is no pose to save"), std::string::npos) << answer.message;
  EXPECT_FALSE(std::filesystem::exists(robot.file("trajectory.txt")));
}

TEST(Lifecycle, TrajectoryIsSavedWhenTheMapperEndsIfThatIsWanted) {
  for (const bool wanted : {false, true}) {
    const std::string name = wanted ? "saves" : "forgets";
    ros::param::set("/" + name + "/save_on_shutdown", wanted);
    Robot robot(name);
    robot.see(0, kUntilMap);
    ASSERT_TRUE(robot.isDone(kUntilMap));
    ASSERT_TRUE(robot.becomesTracking());
    robot.odometry.reset();
    EXPECT_EQ(mapsOf(robot.file("trajectory.txt")).size(), wanted ? 1U : 0U);
    EXPECT_EQ(std::filesystem::exists(robot.file("exposure_trajectory.txt")), wanted);
  }
}

TEST(Lifecycle, PointsOfTheMapAreSavedOnceThereIsOne) {
  Robot robot("cloud");
  std_srvs::Trigger service;
  ASSERT_TRUE(ros::service::call("/cloud/save_points", service));
  EXPECT_FALSE(service.response.success);
  EXPECT_EQ(service.response.message, "there is no map yet");
  robot.see(0, kUntilMap);
  ASSERT_TRUE(robot.isDone(kUntilMap));
  ASSERT_TRUE(robot.becomesTracking());
  ASSERT_TRUE(ros::service::call("/cloud/save_points", service));
  EXPECT_TRUE(service.response.success) << service.response.message;
  EXPECT_NE(service.response.message.find(robot.file("points.ply")), std::string::npos) << service.response.message;
  constexpr std::uintmax_t kHundredPoints = 100 * 3 * sizeof(float);
  EXPECT_GT(std::filesystem::file_size(robot.file("points.ply")), kHundredPoints);
}

}  // namespace
}  // namespace mba_vo::lifecycle_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "lifecycle_test");
  ros::AsyncSpinner spinner(1);
  spinner.start();
  return RUN_ALL_TESTS();
}
