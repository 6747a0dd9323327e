#include "mba_vo/mapping/keyframe_selector.h"

#include <memory>
#include <optional>

#include <gtest/gtest.h>

#include "mba_vo/tracking/frame_measures.h"

namespace mba_vo::keyframe_selector_test {
namespace {

const PinholeCamera kCamera{376, 240, 215.0, 215.0, 187.5, 119.5};
constexpr std::int64_t kInterval = 40'000'000;  // [ns]

/// A wall 2 m away, seen all over the image.
Reference wall() {
  Reference reference;
  reference.pyramid =
      std::make_shared<const ImagePyramid>(cv::Mat1f(kCamera.height, kCamera.width, 100.0F), kCamera, 1);
  for (int y = 10; y < kCamera.height; y += 20) {
    for (int x = 10; x < kCamera.width; x += 20) {
      reference.points.push_back({{static_cast<float>(x), static_cast<float>(y)}, 0.5F, 1e-4F});
    }
  }
  return reference;
}

/// A camera that turns, frame by frame, while the window is busy.
class TurningCamera {
 public:
  /// Turned by so much since the keyframe [rad]. The frame that is to become a keyframe now.
  TrackedFrameConstPtr see(double turned) {
    auto frame = std::make_shared<Frame>();
    frame->sequence = ++frames_;
    frame->mid_exposure_ns = kInterval * static_cast<std::int64_t>(frames_);
    frame->pyramid = *reference_.pyramid;
    auto tracked = std::make_shared<TrackedFrame>();
    tracked->frame = frame;
    tracked->status = TrackingStatus::kTracking;
    tracked->trajectory.T_reference_mid = SE3::exp((Vector6() << 0, 0, 0, 0, turned, 0).finished());
    need_ = KeyframePolicy({}).need(reference_, measureFrame(reference_, tracked->trajectory), {});
    return selector_.add(tracked, tracked->trajectory.T_reference_mid, reference_, true);
  }
  void skip(std::uint64_t frames) { frames_ += frames; }
  /// Of the last frame.
  double need() const { return need_; }
  KeyframeSelector& selector() { return selector_; }

 private:
  const Reference reference_ = wall();
  KeyframeSelector selector_{KeyframePolicyConfig()};
  std::uint64_t frames_ = 0;
  double need_ = 0.0;
};

TEST(KeyframeSelector, WhileTheWindowIsBusyAKeyframeWaitsAsLongAsTheViewStays) {
  TurningCamera camera;
  for (const double turned : {0.10, 0.14, 0.18, 0.21, 0.24, 0.24, 0.24}) EXPECT_FALSE(camera.see(turned)) << turned;
  EXPECT_GT(camera.need(), 1.5) << "a frame has been chosen";
}

TEST(KeyframeSelector, ItIsInsertedWhenTheViewIsLeft) {
  TurningCamera camera;
  EXPECT_FALSE(camera.see(0.10));
  EXPECT_FALSE(camera.see(0.24)) << "chosen";
  EXPECT_TRUE(camera.see(0.36));
  EXPECT_FALSE(camera.see(0.24)) << "another one is to be chosen first";
}

TEST(KeyframeSelector, OneThatCouldNotWaitGetsItsMotionByTheFrameAfterIt) {
  TurningCamera camera;
  for (const double turned : {0.0, 0.02}) EXPECT_FALSE(camera.see(turned));
  ASSERT_TRUE(camera.see(0.42)) << "the view is left all at once";
  EXPECT_FALSE(camera.selector().takeMotionAfterwards()) << "no frame after it has come";
  const double since = (0.42 - 0.02) / (1e-9 * kInterval), before = 0.02 / (1e-9 * kInterval);
  EXPECT_NEAR(camera.selector().motion().velocity(4), since + 0.5 * (since - before), 1e-6);
  camera.see(0.52);
  const std::optional<BodyMotion> motion = camera.selector().takeMotionAfterwards();
  ASSERT_TRUE(motion);
  EXPECT_NEAR(motion->velocity(4), (0.52 - 0.02) / (2 * 1e-9 * kInterval), 1e-6);
  EXPECT_FALSE(camera.selector().takeMotionAfterwards()) << "once";
}

TEST(KeyframeSelector, AFrameThatComesTooLateSaysNothingOfItsMotion) {
  TurningCamera camera;
  for (const double turned : {0.0, 0.02}) EXPECT_FALSE(camera.see(turned));
  ASSERT_TRUE(camera.see(0.42));
  camera.skip(10);
  camera.see(0.52);
  EXPECT_FALSE(camera.selector().takeMotionAfterwards());
}

TEST(KeyframeSelector, OneThatWaitedNeedsNoOtherMotion) {
  TurningCamera camera;
  for (const double turned : {0.10, 0.24, 0.36, 0.40}) camera.see(turned);
  EXPECT_FALSE(camera.selector().takeMotionAfterwards());
}

}  // namespace
}  // namespace mba_vo::keyframe_selector_test
