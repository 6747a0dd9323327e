#include "mba_vo/initialization/initializer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "initialization/textured_room.h"
#include "mba_vo/geometry/se3.h"

namespace mba_vo::initializer_test {
namespace {

constexpr double kFrameInterval = 0.033;  // [s]
constexpr double kExposure = 0.02;        // [s]

/// A hand that shakes (rotates) and moves sideways by `translation` per second.
SE3 poseAt(double t, double translation) {
  Vector6 turn = Vector6::Zero();
  turn.tail<3>() << 0.06 * std::sin(9.0 * t), 0.12 * std::sin(6.0 * t + 1.0), 0.03 * std::sin(5.0 * t);
  const Eigen::Vector3d position(translation * t, 0.3 * translation * t, 0.2 * translation * t);
  return SE3(SE3::exp(turn).rotation(), position);
}

FrameConstPtr makeFrame(int index, const cv::Mat1f& image, double exposure) {
  auto frame = std::make_shared<Frame>();
  frame->sequence = static_cast<std::uint64_t>(index);
  frame->mid_exposure_ns = std::llround(1e9 * kFrameInterval * index);
  frame->exposure = exposure;
  frame->pyramid = ImagePyramid(image, kCamera, 4);
  return frame;
}

FrameConstPtr renderFrame(const Scene& scene, int index, double translation, int blur_samples = 1) {
  const double t = kFrameInterval * index;
  cv::Mat1f sum(kCamera.height, kCamera.width, 0.0F);
  for (int i = 0; i < blur_samples; ++i) {
    const double u = (i + 0.5) / blur_samples - 0.5;
    cv::accumulate(render(scene, poseAt(t + u * kExposure, translation)), sum);
  }
  sum /= blur_samples;
  return makeFrame(index, sum, blur_samples > 1 ? kExposure : 0.0);
}

FrameConstPtr renderRollingFrame(const Scene& scene, int index, double translation, double row_time) {
  PinholeCamera camera = kCamera;
  camera.row_time = row_time;
  const auto T_world_row = [&](int y) { return poseAt(kFrameInterval * index + camera.rowDelay(y), translation); };
  return makeFrame(index, renderRows(scene, T_world_row), 0.0);
}

struct Outcome {
  std::unique_ptr<InitialMap> map;
  std::string reason;
  int frames = 0;
};

Outcome run(const Scene& scene, double translation, int frames, int blur_samples = 1) {
  Initializer initializer((InitializerConfig()));
  Outcome result;
  while (result.frames < frames && !result.map) {
    result.map = initializer.add(renderFrame(scene, result.frames, translation, blur_samples));
    ++result.frames;
  }
  result.reason = initializer.reason();
  return result;
}

/// Depths within `tolerance` (median) and poses within 5 % of the way, after aligning the median depth.
void expectTruth(const Scene& scene, double translation, const InitialMap& map, double tolerance,
                 double row_time = 0.0) {
  const SE3 T_world_reference = poseAt(map.reference->midExposureSeconds(), translation);
  std::vector<double> ratio;  // estimated inverse depth times true depth = true depth of the map's unit
  for (const ReferencePoint& point : map.points) {
    ASSERT_GT(point.inverse_depth, 0.0F);
    ASSERT_GT(point.variance, 0.0F);
    const double delay = (point.pixel.y() - 119.5) * row_time;
    const SE3 T_world_row = poseAt(map.reference->midExposureSeconds() + delay, translation);
    const Eigen::Vector3d ray = T_world_row.rotation() * kCamera.unproject(point.pixel.cast<double>());
    ratio.push_back(point.inverse_depth * scene.hit(T_world_row.translation(), ray).depth);
  }
  ASSERT_GE(ratio.size(), 150U);
  std::sort(ratio.begin(), ratio.end());
  const double scale = ratio[ratio.size() / 2];
  std::vector<double> errors;
  for (const double r : ratio) errors.push_back(std::abs(r / scale - 1.0));
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], tolerance);
  double longest = 0.0;
  for (const InitialMap::Pose& pose : map.poses) {
    const SE3 truth = T_world_reference.inverse() * poseAt(pose.frame->midExposureSeconds(), translation);
    longest = std::max(longest, truth.translation().norm());
  }
  ASSERT_GE(map.poses.size(), 5U);
  for (const InitialMap::Pose& pose : map.poses) {
    const SE3 truth = T_world_reference.inverse() * poseAt(pose.frame->midExposureSeconds(), translation);
    EXPECT_LT((scale * pose.T_reference_frame.translation() - truth.translation()).norm(), 0.05 * longest);
    EXPECT_LT(pose.T_reference_frame.rotation().angularDistance(truth.rotation()), 0.005);
    EXPECT_NE(pose.frame, map.reference);
  }
}

TEST(Initializer, FindsARoom) {
  const Outcome result = run(Scene(), 0.4, 40);
  ASSERT_TRUE(result.map) << result.reason;
  expectTruth(Scene(), 0.4, *result.map, 0.02);
}

TEST(Initializer, FindsARoomInBlurredImages) {
  const Outcome result = run(Scene(), 0.4, 40, 8);
  ASSERT_TRUE(result.map) << result.reason;
  expectTruth(Scene(), 0.4, *result.map, 0.03);
}

TEST(Initializer, FindsAPlane) {
  Scene scene;
  scene.planar = true;
  const Outcome result = run(scene, 0.5, 40);
  ASSERT_TRUE(result.map) << result.reason;
  expectTruth(scene, 0.5, *result.map, 0.03);
}

TEST(Initializer, FindsARoomAndTheRowTimeOfARollingShutter) {
  constexpr double kRowTime = 1e-4;  // [s]
  Initializer initializer(InitializerConfig(), {}, true);
  std::unique_ptr<InitialMap> map;
  for (int i = 0; i < 40 && !map; ++i) map = initializer.add(renderRollingFrame(Scene(), i, 0.4, kRowTime));
  ASSERT_TRUE(map) << initializer.reason();
  EXPECT_NEAR(map->row_time, kRowTime, 0.05 * kRowTime);
  expectTruth(Scene(), 0.4, *map, 0.02, kRowTime);
}

TEST(Initializer, AMapBeginsAsSoonAsItCan) {
  // 2 % of parallax come with the third image; five views are needed, and the newest image is none yet.
  for (const int blur_samples : {1, 8}) {
    const Outcome result = run(Scene(), 1.0, 40, blur_samples);
    ASSERT_TRUE(result.map) << result.reason;
    EXPECT_LE(result.frames, 8) << blur_samples << " samples of blur";
    expectTruth(Scene(), 1.0, *result.map, 0.03);
  }
}

TEST(Initializer, OnlyARollingShutterIsWaitedFor) {
  // Nobody told the row time. Where the images show none, nothing is waited for; else 0.3 s of them come first.
  const auto frames_until_map = [](double row_time) {
    Initializer initializer(InitializerConfig(), {}, true);
    int frames = 0;
    while (frames < 40 && !initializer.add(renderRollingFrame(Scene(), frames, 1.0, row_time))) ++frames;
    return frames + 1;
  };
  EXPECT_LE(frames_until_map(0.0), 8);
  EXPECT_GE(frames_until_map(1e-4), 11);
  EXPECT_LE(frames_until_map(1e-4), 20);
}

TEST(Initializer, MedianDepthIsOneAndPosesAreInOrder) {
  const Outcome result = run(Scene(), 0.4, 40);
  ASSERT_TRUE(result.map) << result.reason;
  std::vector<float> w;
  for (const ReferencePoint& point : result.map->points) w.push_back(point.inverse_depth);
  std::sort(w.begin(), w.end());
  EXPECT_NEAR(w[w.size() / 2], 1.0F, 0.05F);
  for (std::size_t i = 1; i < result.map->poses.size(); ++i) {
    EXPECT_LT(result.map->poses[i - 1].frame->mid_exposure_ns, result.map->poses[i].frame->mid_exposure_ns);
  }
}

TEST(Initializer, RotationAloneGivesNoMapAndSaysSo) {
  const Outcome result = run(Scene(), 0.0, 40);
  EXPECT_FALSE(result.map);
  EXPECT_NE(result.reason.find("only rotation so far"), std::string::npos) << result.reason;
}

TEST(Initializer, PlainImagesGiveAReason) {
  Scene scene;
  scene.textured = false;
  const Outcome result = run(scene, 0.4, 20);
  EXPECT_FALSE(result.map);
  EXPECT_NE(result.reason.find("too little texture"), std::string::npos) << result.reason;
}

TEST(Initializer, ChoosesTheSharpFrame) {
  Initializer initializer((InitializerConfig()));
  std::unique_ptr<InitialMap> map;
  // From here on the camera turns fast for a while.
  for (int i = 9; i < 49 && !map; ++i) map = initializer.add(renderFrame(Scene(), i, 0.4, i == 12 ? 1 : 8));
  ASSERT_TRUE(map) << initializer.reason();
  EXPECT_EQ(map->reference->sequence, 12U);
}

/// After eight images of a camera that turns at a rate [rad/s].
std::string reasonWhileTurning(double rate) {
  Initializer initializer((InitializerConfig()));
  for (int i = 0; i < 8; ++i) {
    Vector6 turn = Vector6::Zero();
    turn(4) = rate * kFrameInterval * (i - 4);
    initializer.add(makeFrame(i, render(Scene(), SE3::exp(turn)), kExposure));
  }
  return initializer.reason();
}

TEST(Initializer, ASharperFrameIsWaitedForWhereBlurIsLong) {
  EXPECT_NE(reasonWhileTurning(13.0 / (215.0 * kExposure)), "waiting for a sharper frame");  // 13 px of blur
  EXPECT_EQ(reasonWhileTurning(20.0 / (215.0 * kExposure)), "waiting for a sharper frame");
}

TEST(Initializer, InvalidPixelsCarryNoPoints) {
  Initializer initializer((InitializerConfig()));
  std::unique_ptr<InitialMap> map;
  for (int i = 0; i < 40 && !map; ++i) {
    cv::Mat1f image = render(Scene(), poseAt(kFrameInterval * i, 0.4));
    image.colRange(0, 60).setTo(std::numeric_limits<float>::quiet_NaN());
    map = initializer.add(makeFrame(i, image, 0.0));
  }
  ASSERT_TRUE(map) << initializer.reason();
  for (const ReferencePoint& point : map->points) EXPECT_GE(point.pixel.x(), 60.0F);
  expectTruth(Scene(), 0.4, *map, 0.02);
}

TEST(Initializer, FramesOnBothSidesOfALongGapAreNotUsedTogether) {
  Initializer initializer((InitializerConfig()));
  for (int i = 0; i < 4; ++i) initializer.add(renderFrame(Scene(), i, 0.4));
  initializer.add(renderFrame(Scene(), 40, 0.4));
  ASSERT_EQ(initializer.bufferedFrames().size(), 1U);
  EXPECT_EQ(initializer.bufferedFrames().front()->sequence, 40U);
}

TEST(Initializer, TimeGoingBackwardsStartsAnew) {
  Initializer initializer((InitializerConfig()));
  for (int i = 10; i < 14; ++i) initializer.add(renderFrame(Scene(), i, 0.4));
  EXPECT_EQ(initializer.bufferedFrames().size(), 4U);
  initializer.add(renderFrame(Scene(), 3, 0.4));
  ASSERT_EQ(initializer.bufferedFrames().size(), 1U);
  EXPECT_EQ(initializer.bufferedFrames().front()->sequence, 3U);
}

TEST(Initializer, BufferIsBoundedInTime) {
  InitializerConfig config;
  config.buffer_seconds = 0.2;
  Initializer initializer(config);
  for (int i = 0; i < 12; ++i) initializer.add(renderFrame(Scene(), i, 0.0));
  EXPECT_EQ(initializer.bufferedFrames().size(), 7U);  // 6 intervals of 33 ms fit in 200 ms
  initializer.reset();
  EXPECT_TRUE(initializer.bufferedFrames().empty());
}

TEST(Initializer, AFrameWithoutImageIsRefused) {
  Initializer initializer((InitializerConfig()));
  EXPECT_THROW(initializer.add(std::make_shared<Frame>()), std::invalid_argument);
  EXPECT_THROW(initializer.add(nullptr), std::invalid_argument);
}

}  // namespace
}  // namespace mba_vo::initializer_test
