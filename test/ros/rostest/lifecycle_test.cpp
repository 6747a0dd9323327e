// What happens to nodes in a robot's life: they are reset, killed and started again, bags are looped, paused and played
// at any speed, and a second camera comes into the same process.
#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "demo_sequence.h"
#include "live_odometry.h"
#include "mba_vo/ros/bag_reader.h"
#include "mba_vo/ros/conversions.h"
#include "sequence_camera.h"

namespace mba_vo {
namespace {

constexpr double kTimeout = 60.0;      // [s]
constexpr double kPatience = 3.0;      // [s] until an image counts as lost, to a nodelet that was not connected yet
constexpr std::size_t kUntilMap = 25;  // images that are enough for a map, and some more

struct Recording {
  DemoSequence sequence;
  std::vector<CameraImage> images;
  CameraCalibration calibration;
};

const Recording& recording() {
  static const Recording once = [] {
    std::string folder;
    if (!ros::param::get("/demo_folder", folder)) throw std::runtime_error("parameter /demo_folder is missing");
    Recording made{makeDemoSequence(folder), {}, {}};
    const auto reader = openBag(made.sequence.bag, {});
    made.calibration = reader->calibration();
    while (auto image = reader->next()) made.images.push_back(*image);
    return made;
  }();
  return once;
}

/// A camera and the nodelets, in namespaces of their own.
class Robot {
 public:
  explicit Robot(const std::string& name, const std::shared_ptr<nodelet::Loader>& manager = nullptr,
                 const std::string& transport = "raw")
      : folder_((std::filesystem::temp_directory_path() / ("mba_vo_lifecycle_" + name)).string()) {
    std::filesystem::remove_all(folder_);
    ros::NodeHandle parameters("/" + name);
    parameters.setParam("extrinsic_wait", 0.0);
    parameters.setParam("path_period", 0.0);
    parameters.setParam("image_transport", transport);
    parameters.setParam("output_directory", folder_);
    for (const char* frame : {"map", "odom", "base", "exposure_start", "exposure_end"}) {
      parameters.setParam(std::string(frame) + "_frame", name + "_" + frame);
    }
    odometry = std::make_unique<LiveOdometry>("/" + name, "/" + name + "_camera", manager);
    const boost::function<void(const TrackedFrameMessageConstPtr&)> on_frame = [this](const auto& message) {
      const std::lock_guard<std::mutex> lock(mutex_);
      tracked_.insert(message->message.tracked->frame->sequence);
      ++to_map_;
      changed_.notify_all();
    };
    const boost::function<void(const nav_msgs::PathConstPtr&)> on_path = [this](const auto& /*path*/) {
      const std::lock_guard<std::mutex> lock(mutex_);
      ++mapped_;
      changed_.notify_all();
    };
    subscribers_ = {parameters.subscribe<TrackedFrameMessage>("tracked_frame", 1000, on_frame),
                    parameters.subscribe<nav_msgs::Path>("path", 1000, on_path)};
    camera = std::make_unique<SequenceCamera>("/" + name + "_camera", recording().images, recording().calibration,
                                              transport);
  }
  ~Robot() {
    odometry.reset();
    std::filesystem::remove_all(folder_);
  }
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;

  /// Sends images [first, end), each when tracker and mapper have dealt with the one before, however slow the machine
  /// is.
  void see(std::size_t first, std::size_t end) {
    ASSERT_TRUE(camera->waitForReaders(kTimeout));
    for (std::size_t i = first; i < end; ++i) {
      camera->send(i);
      std::unique_lock<std::mutex> lock(mutex_);
      ++sent_;
      const auto idle = [this] { return tracked_.size() >= sent_ && mapped_ >= to_map_; };
      if (changed_.wait_for(lock, std::chrono::duration<double>(kPatience), idle)) continue;
      sent_ = tracked_.size();
      mapped_ = to_map_;
    }
  }

  testing::AssertionResult becomesTracking() const {
    const auto is_tracking = [](const Outputs& o) {
      return !o.status.empty() && o.status.back()->state == Status::TRACKING;
    };
    if (odometry->waitFor(is_tracking, kTimeout)) return testing::AssertionSuccess();
    const Outputs outputs = odometry->outputs();
    return testing::AssertionFailure() << *outputs.status.back() << *outputs.mapper_status.back();
  }
  bool isDone(std::uint64_t images) const { return odometry->waitUntilDone(images, kTimeout); }

  std::string file(const std::string& name) const { return folder_ + "/" + name; }

  std::unique_ptr<LiveOdometry> odometry;
  std::unique_ptr<SequenceCamera> camera;

 private:
  std::string folder_;
  std::vector<ros::Subscriber> subscribers_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::set<std::uint64_t> tracked_;                 // numbers of images
  std::size_t sent_ = 0, to_map_ = 0, mapped_ = 0;  // images, and frames that go to the mapper
};

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
        return o.status.size() > statuses + 1 && o.status.back()->reason.find("no image on") == 0;
      },
      kTimeout))
      << "nothing is said while the clock stands still";
  robot.see(kUntilMap, kUntilMap + 10);
  ASSERT_TRUE(robot.isDone(kUntilMap + 10));
  const Status status = robot.odometry->status();
  EXPECT_EQ(status.state, Status::TRACKING);
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
  EXPECT_EQ(right.odometry->status().state, Status::TRACKING);
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

}  // namespace
}  // namespace mba_vo

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "lifecycle_test");
  ros::AsyncSpinner spinner(1);
  spinner.start();
  return RUN_ALL_TESTS();
}
