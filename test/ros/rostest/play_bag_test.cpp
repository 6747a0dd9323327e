// Plays a bag that the test makes itself to both nodelets and looks at everything that comes out.
#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include <gtest/gtest.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/point_cloud2_iterator.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include "demo_sequence.h"
#include "live_odometry.h"
#include "mba_vo/evaluation/evaluator.h"
#include "mba_vo/ros/conversions.h"

namespace mba_vo::play_bag_test {
namespace {

constexpr double kRate = 0.5;      // slower than the camera: the test shall also pass on a busy machine
constexpr double kTimeout = 60.0;  // [s]
const char* const kNamespace = "/mba_vo";

std::string stringParameter(const std::string& name) {
  std::string value;
  if (!ros::param::get(name, value)) {
    throw std::runtime_error("parameter " + name + " is missing");
  }
  return value;
}

SE3 extrinsic() {
  return SE3(T_body_optical().rotation() * Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX()),
             Eigen::Vector3d(0.1, 0.02, 0.2));
}

/// The bag is played once; each test looks at one side of what came out.
class PlayBag : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    sequence_ = new DemoSequence(makeDemoSequence(stringParameter("/demo_folder")));
    geometry_msgs::TransformStamped mount;
    mount.header.frame_id = "base_link";
    mount.child_frame_id = "camera_optical";
    mount.transform = toTransformMsg(extrinsic());
    broadcaster_ = new tf2_ros::StaticTransformBroadcaster();
    broadcaster_->sendTransform(mount);
    odometry_ = new LiveOdometry(kNamespace, "/camera");
    reset_before_any_image_ = odometry_->reset();
    played_ = playBag(sequence_->bag, kRate);
    done_ = odometry_->waitUntilDone(sequence_->stamps.size(), kTimeout);
    outputs_ = new Outputs(odometry_->outputs());
  }
  /// Images of a covered lens, after the bag's last one; their stamps.
  static std::vector<std::int64_t> coverLens(int images) {
    ros::NodeHandle nh;
    const ros::Publisher publisher = nh.advertise<sensor_msgs::Image>("/camera/image_raw", 100);
    const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(kTimeout);
    while (publisher.getNumSubscribers() == 0 && ros::WallTime::now() < deadline) ros::WallDuration(0.01).sleep();
    std::vector<std::int64_t> stamps;
    for (int i = 1; i <= images; ++i) {
      stamps.push_back(sequence_->stamps.back() + i * (sequence_->stamps[1] - sequence_->stamps[0]));
      sensor_msgs::Image image;
      image.header.stamp = toRosTime(stamps.back());
      image.header.frame_id = "camera_optical";
      image.encoding = "mono8";
      image.width = image.step = 376;
      image.height = 240;
      image.data.assign(image.step * image.height,
                        static_cast<unsigned char>(60 + 20 * i));  // repeats are another matter
      publisher.publish(image);
      ros::WallDuration(0.05).sleep();
    }
    return stamps;
  }

  static void TearDownTestSuite() {
    delete odometry_;
    delete outputs_;
    delete broadcaster_;
    delete sequence_;
  }
  void SetUp() override {
    ASSERT_TRUE(played_);
    ASSERT_TRUE(done_) << "images in: " << odometry_->status().frames_in;
  }

  static DemoSequence* sequence_;
  static tf2_ros::StaticTransformBroadcaster* broadcaster_;
  static LiveOdometry* odometry_;
  static Outputs* outputs_;  // of the first play
  static bool reset_before_any_image_, played_, done_;
};
DemoSequence* PlayBag::sequence_ = nullptr;
tf2_ros::StaticTransformBroadcaster* PlayBag::broadcaster_ = nullptr;
LiveOdometry* PlayBag::odometry_ = nullptr;
Outputs* PlayBag::outputs_ = nullptr;
bool PlayBag::reset_before_any_image_ = false, PlayBag::played_ = false, PlayBag::done_ = false;

TEST_F(PlayBag, EveryImageYieldsExactlyOneMotionOrAReason) {
  std::map<std::int64_t, int> motions;
  for (const auto& motion : outputs_->exposure_motion) {
    ++motions[toNanoseconds(motion->header.stamp)];
  }
  std::set<std::int64_t> reasons;
  for (const auto& status : outputs_->status) {
    if (!status->reason.empty()) {
      reasons.insert(toNanoseconds(status->header.stamp));
    }
  }
  for (const std::int64_t stamp : sequence_->stamps) {
    EXPECT_TRUE(motions[stamp] == 1 || (motions[stamp] == 0 && reasons.count(stamp) == 1))
        << "stamp " << stamp << ": " << motions[stamp] << " motions";
  }
  EXPECT_EQ(motions.size(), sequence_->stamps.size()) << "motions with stamps that no image has";
}

TEST_F(PlayBag, CountersAddUp) {
  const Status status = odometry_->status();
  const std::uint64_t images = sequence_->stamps.size();
  EXPECT_EQ(outputs_->status.back()->frames_in, images);
  EXPECT_EQ(finishedImages(*outputs_->status.back()), images);
  EXPECT_EQ(status.frames_missing, 0U);
  EXPECT_EQ(status.frames_shed, 0U);
  EXPECT_EQ(status.frames_rejected, 0U);
  EXPECT_EQ(status.exposure_source, "topic");
  EXPECT_GE(status.frames_tracked + status.frames_degraded, images / 2);
  const MapperStatus& mapper = *outputs_->mapper_status.back();
  EXPECT_EQ(mapper.frames_missing, 0U);
  EXPECT_EQ(mapper.frames_unusable, 0U);
  EXPECT_GE(mapper.frames_in, images);  // some may come twice, once late
}

TEST_F(PlayBag, MeasuredFramesHaveOdometryPoseAndMotion) {
  ASSERT_EQ(outputs_->odometry.size(), outputs_->exposure_motion.size());
  auto pose = outputs_->pose.begin();
  for (std::size_t i = 0; i < outputs_->odometry.size(); ++i) {
    const ExposureMotion& motion = *outputs_->exposure_motion[i];
    const nav_msgs::Odometry& odometry = *outputs_->odometry[i];
    EXPECT_EQ(odometry.header.stamp, motion.mid_time);
    EXPECT_EQ(odometry.header.frame_id + " " + odometry.child_frame_id, "odom base_link");
    EXPECT_EQ(motion.header.frame_id, "odom");
    EXPECT_NEAR(motion.exposure_time, sequence_->exposure, 1e-9);
    for (std::size_t k = 0; k < 36; k += 7)
      EXPECT_GT(std::min(odometry.pose.covariance[k], odometry.twist.covariance[k]), 0.0);
    if (motion.map_id == 0) continue;  // the orientation alone, before there is a map
    ASSERT_NE(pose, outputs_->pose.end());
    EXPECT_EQ((*pose)->header.stamp, motion.mid_time);
    EXPECT_EQ((*pose++)->header.frame_id, "map");
  }
  EXPECT_EQ(pose, outputs_->pose.end());
}

TEST_F(PlayBag, TransformsBelongToTheMotions) {
  using Key = std::pair<std::string, std::int64_t>;
  std::map<Key, geometry_msgs::TransformStamped> transforms;
  for (const auto& transform : outputs_->transforms) {
    const Key key(transform.child_frame_id, toNanoseconds(transform.header.stamp));
    EXPECT_EQ(transforms.count(key), 0U) << key.first << " twice at " << key.second;
    transforms[key] = transform;
  }
  EXPECT_EQ(transforms.size(), 4 * outputs_->pose.size());
  for (const auto& motion : outputs_->exposure_motion) {
    if (motion->map_id == 0) continue;
    const std::int64_t mid = toNanoseconds(motion->mid_time);
    ASSERT_EQ(transforms.count({"odom", mid}), 1U);
    EXPECT_EQ((transforms[{"odom", mid}].header.frame_id), "map");
    EXPECT_EQ((transforms[{"base_link", mid}].header.frame_id), "odom");
    EXPECT_NEAR((transforms[{"exposure_start", mid}].transform.translation.x), motion->start.position.x, 1e-12);
    EXPECT_NEAR((transforms[{"exposure_end", mid}].transform.translation.y), motion->end.position.y, 1e-12);
    // The camera mounted on the base is, at mid-exposure, half way between start and end, but for the acceleration.
    const SE3 mid_camera = fromTransformMsg(transforms[{"base_link", mid}].transform) * extrinsic();
    const SE3 start = fromTransformMsg(transforms[{"exposure_start", mid}].transform);
    const SE3 end = fromTransformMsg(transforms[{"exposure_end", mid}].transform);
    EXPECT_LT((start * SE3::exp(0.5 * (start.inverse() * end).log()) * mid_camera.inverse()).log().norm(), 5e-4);
  }
}

TEST_F(PlayBag, OdometryDoesNotJump) {
  for (std::size_t i = 1; i < outputs_->odometry.size(); ++i) {
    const auto& a = outputs_->odometry[i - 1]->pose.pose.position;
    const auto& b = outputs_->odometry[i]->pose.pose.position;
    const double step = std::sqrt(std::pow(b.x - a.x, 2) + std::pow(b.y - a.y, 2) + std::pow(b.z - a.z, 2));
    EXPECT_LT(step, 0.2) << "at " << outputs_->odometry[i]->header.stamp;  // the room is about 1 unit deep
  }
}

TEST_F(PlayBag, MapIsShown) {
  ASSERT_FALSE(outputs_->path.empty());
  EXPECT_EQ(outputs_->path.back()->header.frame_id, "map");
  EXPECT_GT(outputs_->path.back()->poses.size(), sequence_->stamps.size() / 3);
  ASSERT_FALSE(outputs_->points.empty());
  const sensor_msgs::PointCloud2& points = *outputs_->points.back();
  EXPECT_EQ(points.header.frame_id, "map");
  EXPECT_GT(points.width * points.height, 100U);
  for (sensor_msgs::PointCloud2ConstIterator<float> x(points, "x"), i(points, "intensity"); x != x.end(); ++x, ++i) {
    ASSERT_TRUE(std::isfinite(*x));
    ASSERT_TRUE(*i >= 0.0F && *i <= 255.0F);
  }
  ASSERT_FALSE(outputs_->keyframe_image.empty());
  EXPECT_EQ(outputs_->keyframe_image.back()->width, 376U);
  EXPECT_EQ(outputs_->keyframe_image.back()->encoding, "mono8");
}

TEST_F(PlayBag, NodeletsShareMemory) {
  ASSERT_FALSE(outputs_->tracked_frame.empty());
  ASSERT_FALSE(outputs_->reference.empty());
  std::set<const ImagePyramid*> frames;
  for (const auto& message : outputs_->tracked_frame) {
    ASSERT_NE(message->message.tracked, nullptr) << "tracked_frame was serialised";
    frames.insert(&message->message.tracked->frame->pyramid);
  }
  for (const auto& message : outputs_->reference) {
    ASSERT_NE(message->reference, nullptr) << "reference was serialised";
    // The mapper's keyframe is the very image that the tracker made, at the same address.
    EXPECT_EQ(frames.count(message->reference->pyramid.get()), 1U);
  }
}

TEST_F(PlayBag, WhatIsPublishedIsAccurateAndWrittenDown) {
  const std::string folder = stringParameter(std::string(kNamespace) + "/output_directory");
  for (const char* file : {"/online_trajectory.txt", "/online_exposure_trajectory.txt", "/online_odometry.txt"}) {
    const std::vector<PoseRecord> published = readPoseFile(folder + file);
    EXPECT_EQ(published.size(), outputs_->pose.size()) << file;
    const EvaluationReport report = evaluateTrajectory(sequence_->groundtruth, published, {}, {});
    RecordProperty(std::string("ate_mm") + file, std::to_string(1e3 * report.absolute.rmse));
    EXPECT_LT(report.absolute.rmse, 0.02) << file;
  }
}

TEST_F(PlayBag, SavedTrajectoryIsAccurate) {
  ASSERT_TRUE(odometry_->saveTrajectory());
  const std::string folder = stringParameter(std::string(kNamespace) + "/output_directory");
  const std::vector<PoseRecord> estimate = readPoseFile(folder + "/trajectory.txt");
  const EvaluationReport report = evaluateTrajectory(sequence_->groundtruth, estimate, {}, {});
  EXPECT_LT(report.absolute.rmse, 0.02);
  EXPECT_GE(report.pairs.size(), sequence_->stamps.size() * 8 / 10);
  EXPECT_EQ(readPoseFile(folder + "/exposure_trajectory.txt").size(), estimate.size());
}

TEST_F(PlayBag, BagPlayedAgainIsANewStart) {
  // The clock goes back: nothing was asked for, yet a new map begins.
  const std::uint64_t images = odometry_->status().frames_in + sequence_->stamps.size();
  const std::uint64_t resets = odometry_->status().resets;
  ASSERT_TRUE(playBag(sequence_->bag, kRate));
  ASSERT_TRUE(odometry_->waitUntilDone(images, kTimeout));
  const Status status = odometry_->status();
  EXPECT_EQ(status.resets, resets + 1);
  EXPECT_EQ(status.frames_rejected, 0U);
  EXPECT_GE(odometry_->outputs().exposure_motion.size(), outputs_->exposure_motion.size() * 3 / 2);
  EXPECT_GT(odometry_->outputs().exposure_motion.back()->map_id, outputs_->exposure_motion.back()->map_id);
}

TEST_F(PlayBag, WhileLostTransformsGoOnForAsLongAsTheyMay) {
  ASSERT_NE(odometry_->status().map_id, 0U);
  constexpr int kCovered = 6;  // by tf_prediction, the first three are predicted
  const std::size_t motions = odometry_->outputs().exposure_motion.size();
  const std::size_t before = odometry_->outputs().transforms.size();
  const std::vector<std::int64_t> stamps = coverLens(kCovered);
  ASSERT_TRUE(odometry_->waitFor(
      [&](const Outputs& o) { return toNanoseconds(o.status.back()->header.stamp) == stamps.back(); }, kTimeout));
  const Outputs outputs = odometry_->outputs();
  EXPECT_EQ(outputs.exposure_motion.size(), motions);
  std::vector<std::pair<std::string, std::int64_t>> expected;
  for (std::size_t i = 0; i < 3; ++i) {
    for (const char* child : {"odom", "base_link"}) expected.emplace_back(child, stamps.at(i));
  }
  std::vector<std::pair<std::string, std::int64_t>> sent;
  for (std::size_t i = before; i < outputs.transforms.size(); ++i) {
    sent.emplace_back(outputs.transforms[i].child_frame_id, toNanoseconds(outputs.transforms[i].header.stamp));
  }
  EXPECT_EQ(sent, expected);
  for (const auto& status : outputs.status) {
    const auto found = std::find(stamps.begin(), stamps.end(), toNanoseconds(status->header.stamp));
    if (found == stamps.end()) continue;
    EXPECT_EQ(status->state, Status::LOST);
    EXPECT_EQ(status->tf_predicted, found - stamps.begin() < 3) << status->header.stamp;
  }
}

TEST_F(PlayBag, ResetServiceForgetsTheMap) {
  EXPECT_TRUE(reset_before_any_image_);
  const std::uint64_t resets = odometry_->status().resets;
  ASSERT_TRUE(odometry_->reset());
  EXPECT_TRUE(odometry_->waitFor(
      [resets](const Outputs& outputs) { return outputs.status.back()->resets == resets + 1; }, kTimeout));
  EXPECT_EQ(odometry_->status().state, Status::WAITING);
  EXPECT_EQ(odometry_->status().map_id, 0U);
}

}  // namespace
}  // namespace mba_vo::play_bag_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "play_bag_test");
  ros::AsyncSpinner spinner(1);
  spinner.start();
  return RUN_ALL_TESTS();
}
