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

TrackedFrameConstPtr frameAt(const SE3& T_reference_mid, std::uint64_t sequence) {
  auto frame = std::make_shared<Frame>();
  frame->sequence = sequence;
  frame->mid_exposure_ns = kInterval * static_cast<std::int64_t>(sequence);
  frame->pyramid = *wall().pyramid;
  auto tracked = std::make_shared<TrackedFrame>();
  tracked->frame = frame;
  tracked->status = TrackingStatus::kTracking;
  tracked->trajectory.T_reference_mid = T_reference_mid;
  return tracked;
}

/// A camera that turns, frame by frame, while the window is busy.
class TurningCamera {
 public:
  /// Turned by so much since the keyframe [rad]. The frame that is to become a keyframe now.
  TrackedFrameConstPtr see(double turned) {
    const TrackedFrameConstPtr tracked = frameAt(SE3::exp((Vector6() << 0, 0, 0, 0, turned, 0).finished()), ++frames_);
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

/// Moved sideways, in a map of so many keyframes: whether the frame becomes a keyframe.
bool isTaken(double moved, KeyframeId keyframes, bool busy = false) {
  Reference reference = wall();
  for (KeyframeId id = 0; id < keyframes; ++id) reference.T_map_keyframe[id] = SE3();
  KeyframeSelector selector({});
  bool taken = false;
  for (const std::uint64_t sequence : {1, 2}) {  // the second lets the first be taken
    const TrackedFrameConstPtr tracked = frameAt(SE3(Eigen::Quaterniond::Identity(), {moved, 0.0, 0.0}), sequence);
    taken = selector.add(tracked, tracked->trajectory.T_reference_mid, reference, busy && sequence == 1) != nullptr;
  }
  return taken;
}

/// That gives so much of the parallax that a map asks for.
double moveOf(double share) { return share * KeyframePolicyConfig().parallax_px * 2.0 / kCamera.fx; }

TEST(KeyframeSelector, AMapOfFewKeyframesTakesTheNextAfterLessParallax) {
  // Of the parallax of a grown map; the motion is flow as well.
  const double needed = 1.0 / (1.0 + KeyframePolicyConfig().parallax_px / KeyframePolicyConfig().flow_px);
  EXPECT_FALSE(isTaken(moveOf(0.95 * needed), 6));
  EXPECT_TRUE(isTaken(moveOf(1.05 * needed), 6));
  EXPECT_TRUE(isTaken(moveOf(0.5 * needed), 2));
  EXPECT_FALSE(isTaken(moveOf(0.5 * needed), 2, true)) << "there is enough to do";
  EXPECT_TRUE(isTaken(moveOf(1.05 * needed), 2, true)) << "which keeps no frame from being chosen that is needed";
}

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
