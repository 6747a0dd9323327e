#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "mba_vo/odometry/tracking_loop.h"
#include "odometry/tracking_loop_fixture.h"
#include "support/rendered_room.h"

namespace mba_vo::test::tracking_waiting_test {
namespace {

TEST(TrackingLoop, FramesThatWaitedAreTrackedFromTheHintOn) {
  TrackingLoop loop{OdometryConfig()};
  for (int i = 0; i <= 5; ++i) loop.process(frame(i));
  const auto late = adopt(loop, makeReference(1, 0, 0, someCorrection(), 2));
  ASSERT_EQ(late.size(), 3U);  // frames 3, 4 and 5
  for (int i = 3; i <= 5; ++i) {
    const TrackedFrame& tracked = *late.at(static_cast<std::size_t>(i - 3));
    EXPECT_EQ(tracked.frame->sequence, view(i).id);
    EXPECT_EQ(tracked.status, TrackingStatus::kTracking) << tracked.reason;
    EXPECT_EQ(tracked.reference.map_id, 1U);
    EXPECT_LT(distance(tracked.trajectory.T_reference_mid, truth(0, i)), kClose);
  }
  // Once is enough.
  EXPECT_TRUE(adopt(loop, makeReference(1, 0, 0, someCorrection())).empty());
  const TrackedFrameConstPtr next = loop.process(frame(6));
  EXPECT_EQ(next->status, TrackingStatus::kTracking);
  EXPECT_LT(distance(next->trajectory.T_reference_mid, truth(0, 6)), kClose);
}

TEST(TrackingLoop, WaitingFramesHoldForTheKeyframeTheyAskedFor) {
  TrackingLoop loop(demanding());
  for (int i = 0; i <= 10; ++i) loop.process(frame(i));
  loop.take(makeReference(1, 0, 0, SE3(), 0));
  TrackedFrameConstPtr asking;
  while (!asking || !asking->keyframe_requested) {
    asking = loop.trackWaiting();
    ASSERT_NE(asking, nullptr) << "no frame asked";
  }
  // One more, by which the mapper can make the keyframe, and no other before it is there.
  const TrackedFrameConstPtr one_more = loop.trackWaiting();
  ASSERT_NE(one_more, nullptr);
  const auto next = static_cast<int>(one_more->frame->sequence - view(0).id) + 1;
  ASSERT_LT(next, 11);
  EXPECT_EQ(loop.trackWaiting(), nullptr);
  EXPECT_EQ(loop.waitingFrames(), static_cast<std::size_t>(11 - next));
  // A better image of the keyframe in use is not the keyframe that was asked for.
  const auto sharper = makeReference(1, 0, 0, SE3(), {});
  sharper->cause = ReferenceCause::kSharperImage;
  EXPECT_TRUE(loop.take(sharper));
  EXPECT_EQ(loop.reference(), sharper);
  EXPECT_EQ(loop.trackWaiting(), nullptr);
  EXPECT_EQ(loop.waitingFrames(), static_cast<std::size_t>(11 - next));
  EXPECT_EQ(loop.process(frame(11))->status, TrackingStatus::kInitializing);  // it waits behind the others
  EXPECT_EQ(loop.trackWaiting(), nullptr);

  auto reference = makeReference(1, 1, next - 2, truth(0, next - 2));
  reference->T_map_keyframe[0] = SE3();
  EXPECT_FALSE(adopt(loop, reference).empty());
  // If it does not come, frames of 0.3 s later are no longer held up.
  int i = 12;
  while (loop.waitingFrames() > 0 && i < kCount) {
    loop.process(frame(i++));
    while (loop.trackWaiting()) {
    }
  }
  const TrackedFrameConstPtr at_last = loop.process(elsewhere(0.35));
  EXPECT_EQ(at_last->status, loop.waitingFrames() > 0 ? TrackingStatus::kInitializing : TrackingStatus::kLost);
  while (loop.trackWaiting() || loop.hasFailedToLeap()) {
  }
  EXPECT_EQ(loop.waitingFrames(), 0U);
}

/// Frames 1 to `last` wait when the map begins with frame 0.
void letWait(TrackingLoop& loop, int last) {
  for (int i = 0; i <= last; ++i) loop.process(frame(i));
  ASSERT_TRUE(loop.take(makeReference(1, 0, 0, SE3(), 0)));
}

TEST(TrackingLoop, WhereManyWaitItGoesOnFromTheNewestAtOnce) {
  constexpr int kLast = 12;
  TrackingLoop loop{OdometryConfig()};
  letWait(loop, kLast);
  const TrackedFrameConstPtr newest = loop.trackWaiting();
  ASSERT_NE(newest, nullptr);
  EXPECT_EQ(newest->frame->sequence, view(kLast).id);
  EXPECT_LT(distance(newest->trajectory.T_reference_mid, truth(0, kLast)), kClose);
  EXPECT_EQ(newest->status, TrackingStatus::kDegraded) << "nothing confirms it yet";
  EXPECT_EQ(loop.phase(), TrackingPhase::kTracking);
  const std::vector<TrackedFrameConstPtr> placed = loop.takeInterpolated();
  ASSERT_EQ(placed.size(), static_cast<std::size_t>(kLast - 1));
  for (int i = 1; i < kLast; ++i) {
    const TrackedFrame& between = *placed.at(static_cast<std::size_t>(i - 1));
    EXPECT_EQ(between.frame->sequence, view(i).id);
    const Vector6 error = (truth(0, i).inverse() * between.trajectory.T_reference_mid).log();
    const Matrix6 covariance = between.covariance.topLeftCorner<6, 6>();
    EXPECT_LT(error.dot(covariance.ldlt().solve(error)), 9.0 * 6.0) << "it says how well it is known";
  }
  EXPECT_EQ(loop.process(frame(kLast + 1))->status, TrackingStatus::kTracking);
}

TEST(TrackingLoop, ALeapThatIsTooFarIsTriedHalfAsFar) {
  constexpr int kLast = 12;
  TrackingLoop loop{OdometryConfig()};
  for (int i = 0; i < kLast; ++i) loop.process(frame(i));
  loop.process(elsewhere(0.0));
  loop.take(makeReference(1, 0, 0, SE3(), 0));
  EXPECT_EQ(loop.trackWaiting(), nullptr);
  EXPECT_TRUE(loop.hasFailedToLeap());
  EXPECT_EQ(loop.waitingFrames(), static_cast<std::size_t>(kLast));
  const TrackedFrameConstPtr half = loop.trackWaiting();
  ASSERT_NE(half, nullptr);
  EXPECT_FALSE(loop.hasFailedToLeap());
  EXPECT_GT(half->frame->sequence, view(2).id);
  EXPECT_LT(half->frame->sequence, view(kLast - 1).id);
  const auto reached = static_cast<int>(half->frame->sequence - view(0).id);
  EXPECT_LT(distance(half->trajectory.T_reference_mid, truth(0, reached)), kClose);
}

TEST(TrackingLoop, WhereImagesComeTooFastSomeAreLeftOut) {
  TrackingLoop loop{OdometryConfig()};
  adopt(loop, makeReference(1, 0, 0, SE3(), 0));
  ASSERT_EQ(loop.process(frame(1), Backlog::kSome)->status, TrackingStatus::kTracking);
  for (int i = 2; i <= 3; ++i) {
    const TrackedFrameConstPtr waits = loop.process(frame(i), i < 3 ? Backlog::kTooMuch : Backlog::kSome);
    EXPECT_EQ(waits->status, TrackingStatus::kInitializing);
    EXPECT_EQ(loop.phase(), TrackingPhase::kCatchingUp);
  }
  const TrackedFrameConstPtr newest = loop.process(frame(4), Backlog::kNothing);
  EXPECT_EQ(newest->frame->sequence, view(4).id);
  EXPECT_EQ(newest->status, TrackingStatus::kDegraded) << "nothing confirms it yet";
  EXPECT_LT(distance(newest->trajectory.T_reference_mid, truth(0, 4)), kClose);
  EXPECT_EQ(loop.takeInterpolated().size(), 2U);
  EXPECT_EQ(loop.phase(), TrackingPhase::kTracking);
  EXPECT_EQ(loop.waitingFrames(), 0U);
}

TEST(TrackingLoop, ANewestImageOutOfReachWaitsWithTheOthers) {
  TrackingLoop loop{OdometryConfig()};
  adopt(loop, makeReference(1, 0, 0, SE3(), 0));
  for (int i = 1; i <= 3; ++i) loop.process(frame(i), Backlog::kTooMuch);
  const TrackedFrameConstPtr newest = loop.process(elsewhere(0.2));
  EXPECT_EQ(newest->status, TrackingStatus::kInitializing);
  EXPECT_TRUE(loop.hasFailedToLeap());
  EXPECT_EQ(loop.waitingFrames(), 4U);
  const TrackedFrameConstPtr late = loop.trackWaiting();
  ASSERT_NE(late, nullptr);
  EXPECT_LE(late->frame->sequence, view(3).id);
}

TEST(TrackingLoop, WhereNothingThatWaitsCanBeAlignedTheNewestImageIsLookedFor) {
  TrackingLoop loop{OdometryConfig()};
  adopt(loop, makeReference(1, 0, 0, SE3(), 0));
  loop.process(frame(1));
  for (int i = 0; i < 8; ++i) loop.process(elsewhere(0.1 + 0.03 * i), Backlog::kTooMuch);
  // Three leaps, each half as far as the one before, and three frames one after the other.
  for (int tried = 0; loop.phase() == TrackingPhase::kCatchingUp && tried < 6; ++tried) loop.trackWaiting();
  EXPECT_EQ(loop.phase(), TrackingPhase::kLost);
  EXPECT_EQ(loop.waitingFrames(), 0U);
}

TEST(TrackingLoop, FramesThatSawTheirReferenceBadlyAreTrackedAgainAgainstTheNext) {
  constexpr int kLast = 9;
  constexpr int kKeyframe = 5;
  TrackingLoop loop(demanding());
  adopt(loop, makeReference(1, 0, 0, SE3(), 0));
  std::vector<TrackedFrameConstPtr> first;
  for (int i = 1; i <= kLast; ++i) first.push_back(loop.process(frame(i)));
  // The mapper gets a few frames to make the keyframe of, and the rest when they are seen better.
  EXPECT_FALSE(first.front()->provisional);
  EXPECT_TRUE(first.back()->provisional);
  const SE3 odometry_before = loop.T_odom_camera();

  auto next = makeReference(1, 1, kKeyframe, truth(0, kKeyframe));
  next->T_map_keyframe[0] = SE3();
  const auto late = adopt(loop, next);
  ASSERT_EQ(late.size(), static_cast<std::size_t>(kLast - kKeyframe)) << "the frames after the reference's image";
  for (int i = kKeyframe + 1; i <= kLast; ++i) {
    const TrackedFrame& tracked = *late.at(static_cast<std::size_t>(i - kKeyframe - 1));
    EXPECT_EQ(tracked.frame->sequence, view(i).id);
    EXPECT_EQ(tracked.reference.keyframe_id, 1U);
    EXPECT_EQ(tracked.status, TrackingStatus::kTracking) << tracked.reason;
    EXPECT_LT(distance(tracked.trajectory.T_reference_mid, truth(kKeyframe, i)), kClose);
  }
  EXPECT_FALSE(late.front()->provisional);
  EXPECT_LT(distance(loop.T_odom_camera(), odometry_before), 2 * kClose);
  EXPECT_EQ(loop.process(frame(kLast + 1))->reference.keyframe_id, 1U);
}

TEST(TrackingLoop, WithoutTimeItDoesNotGoBack) {
  TrackingLoop loop(demanding());
  adopt(loop, makeReference(1, 0, 0, SE3(), 0));
  for (int i = 1; i <= 9; ++i) loop.process(frame(i));
  auto next = makeReference(1, 1, 5, truth(0, 5));
  next->T_map_keyframe[0] = SE3();
  ASSERT_TRUE(loop.take(next, false));
  EXPECT_EQ(loop.trackWaiting(), nullptr);
  const TrackedFrameConstPtr tracked = loop.process(frame(10));
  EXPECT_EQ(tracked->reference.keyframe_id, 1U);
  EXPECT_LT(distance(tracked->trajectory.T_reference_mid, truth(5, 10)), kClose);
}

TEST(TrackingLoop, FramesAreNotProvisionalForever) {
  TrackingLoop loop(demanding());
  adopt(loop, makeReference(1, 0, 0, SE3(), 0));
  bool was_provisional = false;
  for (int i = 1; i < kCount; ++i) was_provisional |= loop.process(frame(i))->provisional;
  EXPECT_TRUE(was_provisional);
  // The same view, though not the same noise, much later: no keyframe came.
  const SimulatedFrame& last = view(kCount - 1);
  const TrackedFrameConstPtr tracked = loop.process(makeFrame(
      scaled(toFloat(last.blurred), 1.0, 0.1), last.mid_exposure_ns + std::llround(0.6e9), last.exposure, 500));
  ASSERT_TRUE(tracked->tracked()) << tracked->reason;
  EXPECT_FALSE(tracked->provisional);
}

}  // namespace
}  // namespace mba_vo::test::tracking_waiting_test
