// What a user gets wrong about the topics themselves: types, transports, units, and nodelets that are not there.
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/CompressedImage.h>
#include <std_msgs/Int32.h>
#include <opencv2/imgcodecs.hpp>

#include "bad_input.h"

namespace mba_vo::bad_topics_test {
namespace {

TEST_F(BadInput, TopicsOfTheWrongTypeAreNamed) {
  images_.shutdown();
  ros::Publisher wrong = nh_.advertise<sensor_msgs::CameraInfo>("image_raw", 1);
  EXPECT_TRUE(odometry_->waitFor(
      [](const Outputs& o) {
        return o.status.back()->reason.find("published as sensor_msgs/CameraInfo, sensor_msgs/Image is needed") !=
               std::string::npos;
      },
      kTimeout));
  wrong.shutdown();
  wrong = nh_.advertise<sensor_msgs::CompressedImage>("image_raw/compressed", 1);
  EXPECT_TRUE(odometry_->waitFor(
      [](const Outputs& o) {
        return o.status.back()->reason.find("tell image_transport:=compressed") != std::string::npos;
      },
      kTimeout));
}

TEST_F(BadInput, WhileEveryImageIsRejectedTheStatusSaysWhy) {
  sendCameraInfo();
  sendImage(stamp(0));
  ASSERT_TRUE(done());
  int sent = 1;
  EXPECT_TRUE(odometry_->waitFor(
      [&](const Outputs& o) {
        sendImage(stamp(sent++), "mono8", 200);
        return o.status.back()->state == Status::WAITING && o.status.back()->reason.find("200") != std::string::npos &&
               o.status.back()->frames_initializing == 1;
      },
      kTimeout));
  sendImage(stamp(sent));
  ASSERT_TRUE(done());
  EXPECT_EQ(odometry_->status().state, Status::INITIALIZING);
}

TEST_F(BadInput, ExposuresInMicrosecondsAreNoticed) {
  sendCameraInfo();
  int sent = 0;
  EXPECT_TRUE(odometry_->waitFor(
      [&](const Outputs& o) {
        sendExposure(stamp(sent), 12e3);
        sendImage(stamp(sent++));
        return !o.status.empty() &&
               o.status.back()->reason.find("if these are microseconds, it is 0.012 s") != std::string::npos;
      },
      kTimeout));
}

/// What a tracker of its own does with an image that was compressed without loss, and with one that was not at all.
TEST_F(BadInput, CompressedImagesAreTheirDecodedTwins) {
  ros::NodeHandle parameters("/twin");
  parameters.setParam("image_transport", "compressed");
  parameters.setParam("publish_tf", false);
  parameters.setParam("record", false);
  LiveOdometry twin("/twin", "/" + name_ + "_camera");
  ros::Publisher compressed = nh_.advertise<sensor_msgs::CompressedImage>("image_raw/compressed", 10);
  waitForSubscribers(compressed);
  sendCameraInfo();
  cv::Mat1b picture(120, 160);
  cv::randu(picture, 0, 255);
  std_msgs::Header header;
  header.stamp = toRosTime(stamp(0));
  header.frame_id = "camera";
  images_.publish(cv_bridge::CvImage(header, "mono8", picture).toImageMsg());
  sensor_msgs::CompressedImage message;
  message.header = header;
  message.format = "mono8; png compressed ";
  cv::imencode(".png", picture, message.data);
  compressed.publish(message);
  message.header.stamp = toRosTime(stamp(1));
  message.data.resize(30);
  compressed.publish(message);
  ASSERT_TRUE(odometry_->waitUntilDone(1, kTimeout));
  ASSERT_TRUE(twin.waitUntilDone(2, kTimeout));
  const auto raw = odometry_->outputs().tracked_frame.at(0);
  const auto decoded = twin.outputs().tracked_frame.at(0);
  const auto pixelsOf = [](const TrackedFrameMessage& m) {
    return m.message.tracked->frame->pyramid.level(0).intensity;
  };
  const cv::Mat1f expected = pixelsOf(*raw), actual = pixelsOf(*decoded);
  ASSERT_EQ(actual.size(), expected.size());
  EXPECT_EQ(std::memcmp(actual.data, expected.data, expected.total() * sizeof(float)), 0);  // also where they are NaN
  EXPECT_EQ(decoded->summary.header.stamp, raw->summary.header.stamp);
  EXPECT_EQ(decoded->summary.sequence, 0U);
  EXPECT_EQ(twin.status().frames_rejected, 1U);
  const auto statuses = twin.outputs().status;
  EXPECT_TRUE(std::any_of(statuses.begin(), statuses.end(), [](const auto& status) {
    return status->reason.find("'mono8; png compressed ' and 30 bytes cannot be decoded") != std::string::npos;
  }));
}

TEST_F(BadInput, WithoutAMapperTheTrackerSaysSo) {
  constexpr bool kWithMapper = false;
  ros::NodeHandle("/alone").setParam("record", false);
  const LiveOdometry alone("/alone", "/" + name_ + "_camera", nullptr, kWithMapper);
  sendCameraInfo();
  int sent = 0;
  EXPECT_TRUE(alone.waitFor(
      [&](const Outputs& o) {
        sendImage(stamp(sent++));
        return std::any_of(o.status.begin(), o.status.end(), [](const auto& status) {
          return status->reason.find("no mapper: nobody publishes /alone/reference") != std::string::npos;
        });
      },
      kTimeout));
}

/// With room for five images most are shed that come at once, because their exposures come late; the last ones wait for
/// theirs when the tracker ends.
TEST_F(BadInput, EveryImageIsWrittenDownWhateverBecomesOfIt) {
  const std::string folder = (std::filesystem::temp_directory_path() / ("mba_vo_" + name_)).string();
  ros::NodeHandle parameters("/hurried");
  parameters.setParam("image_queue_mb", 0.1);
  parameters.setParam("exposure_wait", 10.0);
  parameters.setParam("publish_tf", false);
  parameters.setParam("output_directory", folder);
  auto hurried = std::make_unique<LiveOdometry>("/hurried", "/" + name_ + "_camera");
  const auto send = [this](int from, int to) {
    for (int i = from; i < to; ++i) sendImage(stamp(i));
  };
  const auto has_come = [this](const Outputs& o) { return o.status.back()->frames_in == sent_; };
  sendCameraInfo();
  send(0, 60);
  ASSERT_TRUE(hurried->waitFor(has_come, kTimeout));
  sendExposure(stamp(60), 0.01);
  ASSERT_TRUE(hurried->waitUntilDone(sent_, kTimeout));
  const std::uint64_t shed = hurried->status().frames_shed;
  EXPECT_GT(shed, 0U);
  send(61, 70);
  ASSERT_TRUE(hurried->waitFor(has_come, kTimeout));
  hurried.reset();
  std::map<std::string, std::uint64_t> rows;
  std::ifstream frames(folder + "/frames.csv");
  std::string line;
  std::getline(frames, line);  // the header
  while (std::getline(frames, line)) ++rows[line.find(",SHED,") == std::string::npos ? "others" : "shed"];
  EXPECT_EQ(rows["shed"] + rows["others"], sent_);
  EXPECT_GE(rows["shed"], shed);
  std::filesystem::remove_all(folder);
}

/// Half an exposure before its stamp is before the beginning of time, which no message can tell.
TEST_F(BadInput, TheImageThatTheTrackerFailsOnIsWrittenDown) {
  const std::string folder = (std::filesystem::temp_directory_path() / ("mba_vo_" + name_)).string();
  ros::NodeHandle parameters("/failing");
  parameters.setParam("stamp_reference", "end");
  parameters.setParam("exposure_time", 0.02);
  parameters.setParam("publish_tf", false);
  parameters.setParam("output_directory", folder);
  auto failing = std::make_unique<LiveOdometry>("/failing", "/" + name_ + "_camera");
  sendCameraInfo();
  sendImage(5'000'000);
  ASSERT_TRUE(failing->waitFor(
      [](const Outputs& o) { return !o.status.empty() && o.status.back()->frames_failed == 1; }, kTimeout));
  sendImage(stamp(0));
  ASSERT_TRUE(failing->waitUntilDone(2, kTimeout));
  EXPECT_EQ(failing->status().frames_initializing, 1U) << "it goes on";
  failing.reset();
  std::ifstream frames(folder + "/frames.csv");
  std::string header, failed, next, more;
  std::getline(frames, header);
  std::getline(frames, failed);
  std::getline(frames, next);
  EXPECT_EQ(failed.rfind("0,", 0), 0U) << failed;
  EXPECT_NE(failed.find(",REJECTED,"), std::string::npos) << failed;
  EXPECT_NE(failed.find("the tracker failed: "), std::string::npos) << failed;
  EXPECT_EQ(next.rfind("1,", 0), 0U) << next;
  EXPECT_NE(next.find(",INITIALIZING,"), std::string::npos) << next;
  EXPECT_FALSE(std::getline(frames, more)) << more;
  std::filesystem::remove_all(folder);
}

/// The node of bad_input.test, with the preset of a driver that sends bare numbers.
TEST(ExposureRelay, GivesEachImageTheNumberThatArrivesNextToIt) {
  ros::NodeHandle nh("/relay");
  std::mutex mutex;
  std::vector<ExposureStampedConstPtr> exposures;
  const boost::function<void(const ExposureStampedConstPtr&)> listen = [&](const auto& exposure) {
    const std::lock_guard<std::mutex> lock(mutex);
    exposures.push_back(exposure);
  };
  const ros::Subscriber subscriber = nh.subscribe<ExposureStamped>("exposure", 100, listen);
  const ros::Publisher infos = nh.advertise<sensor_msgs::CameraInfo>("camera_info", 100);
  const ros::Publisher numbers = nh.advertise<std_msgs::Int32>("number", 100);
  const auto waitFor = [](const std::function<bool()>& condition) {
    const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(kTimeout);
    while (!condition() && ros::WallTime::now() < deadline) ros::WallDuration(0.01).sleep();
    return condition();
  };
  ASSERT_TRUE(waitFor([&] {
    return infos.getNumSubscribers() > 0 && numbers.getNumSubscribers() > 0 && subscriber.getNumPublishers() > 0;
  }));
  for (std::size_t i = 0; i < 3; ++i) {
    sensor_msgs::CameraInfo info;
    info.header.stamp = ros::Time(100 + static_cast<double>(i));
    infos.publish(info);
    std_msgs::Int32 number;
    number.data = 10000 + static_cast<int>(i);
    numbers.publish(number);
    const auto count = [&] {
      const std::lock_guard<std::mutex> lock(mutex);
      return exposures.size();
    };
    ASSERT_TRUE(waitFor([&] { return count() == i + 1; }));
    EXPECT_EQ(exposures[i]->header.stamp, info.header.stamp);
    EXPECT_NEAR(exposures[i]->exposure_time, 1e-6 * number.data, 1e-9);
  }
}

/// In a process of its own, which unloads the nodelet's library when it fails.
TEST(TrackerAlone, ATransportThatIsNotThereEndsTheStartWithoutACrash) {
  for (const char* parameter : {"image_transport", "depth_transport"}) {
    ros::NodeHandle("/wrong_transport").setParam(parameter, "theora");
    const int status = std::system(
        "timeout 60 rosrun nodelet nodelet standalone mba_vo/Tracker __ns:=wrong_transport __name:=tracking < "
        "/dev/null");
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 255) << "139 = it crashed, 124 = it runs on";
    ros::NodeHandle("/wrong_transport").deleteParam(parameter);
  }
}

}  // namespace
}  // namespace mba_vo::bad_topics_test
