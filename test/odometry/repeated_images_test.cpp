#include <algorithm>
#include <map>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "mba_vo/odometry/config_yaml.h"
#include "mba_vo/odometry/live_simulation.h"
#include "support/rendered_sequence.h"

namespace mba_vo::repeated_images_test {
namespace {

constexpr double kExposure = 0.03;  // [s]
constexpr int kImages = 80;
constexpr int kFirstRepeat = 8;  // every fourth image from there on

const test::RenderedSequence& sequence() {
  static const test::RenderedSequence rendered = [] {
    SimulationConfig config = test::sequenceConfig(kExposure);
    config.trajectory_seed = 3;
    return test::renderFrames(config, 0, kImages);
  }();
  return rendered;
}

bool isRepeat(std::size_t index) { return index >= kFirstRepeat && index % 4 == 0; }

cv::Mat recompressed(const cv::Mat& image) {
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, 90});
  return cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
}

/// A stream that now and then repeats an image where the next one should be, by turns to the byte and compressed.
std::vector<CameraImage> stream() {
  std::vector<CameraImage> images;
  for (const SimulatedFrame& frame : sequence().frames) {
    CameraImage image;
    image.sequence = frame.id;
    image.stamp_ns = image.mid_exposure_ns = frame.mid_exposure_ns;
    image.exposure = kExposure;
    image.image = frame.blurred;
    if (isRepeat(images.size())) {
      const cv::Mat& before = images.back().image;
      image.image = images.size() % 8 == 0 ? before : recompressed(before);
    }
    images.push_back(image);
  }
  return images;
}

struct StreamRun {
  std::map<std::uint64_t, TrackerStep> steps;  // by image
  std::map<std::uint64_t, TrajectoryEntry> trajectory;
  std::vector<std::uint64_t> keyframes;  // their images
};

StreamRun runLive(const std::vector<CameraImage>& images) {
  OdometryConfig config;
  config.mapper.deterministic = true;
  finalize(config);
  LiveSimulation live(config, Machine());
  live.setCalibration(sequence().calibration, {});
  StreamRun run;
  const auto take = [&](const OdometryResult& result) {
    for (const PublishedImage& image : result.images) run.steps[image.step.sequence] = image.step;
    for (const MapperOutput& output : result.mapping) {
      if (output.keyframe) run.keyframes.push_back(output.keyframe->frame_sequence);
    }
  };
  for (const CameraImage& image : images) take(live.process(image));
  take(live.finish());
  for (const TrajectoryEntry& entry : live.mapper().finishedTrajectory()) run.trajectory[entry.frame_sequence] = entry;
  return run;
}

class RepeatedImages : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    images_ = stream();
    run_ = runLive(images_);
  }
  static std::vector<CameraImage> images_;
  static StreamRun run_;
};
std::vector<CameraImage> RepeatedImages::images_;
StreamRun RepeatedImages::run_;

TEST_F(RepeatedImages, HaveNoPoseOfTheirOwnAndAreNoKeyframes) {
  ASSERT_EQ(run_.steps.size(), images_.size()) << "every image is accounted for";
  for (std::size_t i = 0; i < images_.size(); ++i) {
    const TrackerStep& step = run_.steps.at(images_[i].sequence);
    EXPECT_EQ(step.kind == TrackerStep::Kind::kRepeated, isRepeat(i)) << i;
    if (!isRepeat(i)) continue;
    EXPECT_THAT(step.reason, testing::HasSubstr("repeats the image of " +
                                                std::to_string(1e-9 * double(images_[i - 1].stamp_ns)) + " s"));
    EXPECT_EQ(step.message.tracked, nullptr) << "nothing for the mapper";
    EXPECT_EQ(run_.trajectory.count(images_[i].sequence), 0U);
    EXPECT_THAT(run_.keyframes, testing::Not(testing::Contains(images_[i].sequence)));
  }
}

TEST_F(RepeatedImages, HaveThePoseOfTheImageThatTheyRepeatUnderTheirOwnStamp) {
  int posed = 0;
  for (std::size_t i = kFirstRepeat; i < images_.size(); i += 4) {
    const TrackerStep& step = run_.steps.at(images_[i].sequence);
    const TrackerStep& original = run_.steps.at(images_[i - 1].sequence);
    ASSERT_NE(step.repeated, nullptr);
    EXPECT_EQ(step.stamp_ns, images_[i].stamp_ns);
    EXPECT_EQ(step.repeated->frame->stamp_ns, images_[i].stamp_ns);
    EXPECT_EQ(step.repeated->frame->mid_exposure_ns, images_[i - 1].mid_exposure_ns);
    EXPECT_EQ(step.repeated->status, original.message.tracked->status);
    EXPECT_LT((step.T_odom_camera.inverse() * original.T_odom_camera).log().norm(), 1e-12);
    posed += step.repeated->tracked() ? 1 : 0;
  }
  EXPECT_GT(posed, 8);
}

TEST_F(RepeatedImages, TheOthersAreTrackedAsIfNothingWere) {
  int distinct = 0;
  int posed = 0;
  for (std::size_t i = 0; i < images_.size(); ++i) {
    if (isRepeat(i)) continue;
    ++distinct;
    posed += static_cast<int>(run_.trajectory.count(images_[i].sequence));
  }
  EXPECT_GE(posed, 0.95 * distinct);
}

TEST_F(RepeatedImages, SecondsOfOneImageAtFirstDoNoHarm) {
  std::vector<CameraImage> images;
  const std::int64_t interval = images_[1].stamp_ns - images_[0].stamp_ns;
  constexpr int kStill = 60;
  for (int i = 0; i < kStill; ++i) {
    images.push_back(images_[0]);
    images.back().sequence = static_cast<std::uint64_t>(i);
    images.back().stamp_ns = images.back().mid_exposure_ns = images_[0].stamp_ns - (kStill - i) * interval;
  }
  for (const CameraImage& image : images_) {
    images.push_back(image);
    images.back().sequence = images.size() - 1;
  }
  const StreamRun run = runLive(images);
  ASSERT_EQ(run.steps.size(), images.size());
  EXPECT_EQ(run.steps.at(3).kind, TrackerStep::Kind::kRepeated);
  EXPECT_TRUE(run.steps.at(kStill - 1).message.tracked->blind) << "frozen";
  EXPECT_GE(run.trajectory.size() + 3U, run_.trajectory.size());
}

}  // namespace
}  // namespace mba_vo::repeated_images_test
