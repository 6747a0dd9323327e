// New frames while frames before them are tracked once more.
#include <memory>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "mba_vo/odometry/tracking_loop.h"
#include "odometry/tracking_loop_fixture.h"
#include "support/rendered_room.h"

namespace mba_vo::test::tracking_ahead_test {
namespace {

constexpr int kLast = 9;
constexpr int kKeyframe = 5;

ReferenceConstPtr keyframeAt(int index) {
  auto reference = makeReference(1, 1, index, truth(0, index));
  reference->T_map_keyframe[0] = SE3();
  return reference;
}

/// Frames 1 to `last` leave the view of the reference at frame 0.
void leaveTheView(TrackingLoop& loop, int last) {
  adopt(loop, makeReference(1, 0, 0, SE3(), 0));
  for (int i = 1; i <= last; ++i) loop.process(frame(i));
}

void expectTracked(const TrackedFrame& tracked, int index) {
  EXPECT_EQ(tracked.frame->sequence, view(index).id);
  EXPECT_EQ(tracked.reference.keyframe_id, 1U);
  ASSERT_TRUE(tracked.tracked()) << tracked.reason;
  EXPECT_LT(distance(tracked.trajectory.T_reference_mid, truth(kKeyframe, index)), kClose);
}

TEST(TrackingAhead, ANewFrameGetsAFirstResultAtOnceAndAnotherInItsTurn) {
  TrackingLoop loop(demanding());
  leaveTheView(loop, kLast);
  EXPECT_NE(loop.phase(), TrackingPhase::kRevising);
  ASSERT_TRUE(loop.take(keyframeAt(kKeyframe)));
  ASSERT_EQ(loop.phase(), TrackingPhase::kRevising);
  EXPECT_NE(loop.phase(), TrackingPhase::kCatchingUp);
  const TrackedFrameConstPtr again = loop.trackWaiting();
  ASSERT_NE(again, nullptr);
  expectTracked(*again, kKeyframe + 1);
  EXPECT_FALSE(again->provisional);

  const TrackedFrameConstPtr first = loop.process(frame(kLast + 1));
  expectTracked(*first, kLast + 1);
  EXPECT_TRUE(first->provisional);
  expectConsistent(loop, *first);
  EXPECT_EQ(loop.phase(), TrackingPhase::kRevising);
  for (int i = kKeyframe + 2; i <= kLast + 1; ++i) {
    const TrackedFrameConstPtr late = loop.trackWaiting();
    ASSERT_NE(late, nullptr) << i;
    expectTracked(*late, i);
  }
  EXPECT_EQ(loop.trackWaiting(), nullptr);
  EXPECT_NE(loop.phase(), TrackingPhase::kRevising);
  const TrackedFrameConstPtr next = loop.process(frame(kLast + 2));
  expectTracked(*next, kLast + 2);
  expectConsistent(loop, *next);
}

TEST(TrackingAhead, AnotherReferenceMayComeMeanwhile) {
  TrackingLoop loop(demanding());
  leaveTheView(loop, kLast);
  ASSERT_TRUE(loop.take(keyframeAt(kKeyframe - 2)));
  ASSERT_NE(loop.trackWaiting(), nullptr);
  ASSERT_TRUE(loop.process(frame(kLast + 1))->tracked());
  auto moved = makeReference(1, 2, kKeyframe, someCorrection() * truth(0, kKeyframe));
  moved->T_map_keyframe[1] = someCorrection() * truth(0, kKeyframe - 2);  // the map has been optimised
  ASSERT_TRUE(loop.take(moved));
  ASSERT_EQ(loop.phase(), TrackingPhase::kRevising);
  const TrackedFrameConstPtr ahead = loop.process(frame(kLast + 2));
  ASSERT_TRUE(ahead->tracked()) << ahead->reason;
  EXPECT_LT(distance(ahead->trajectory.T_reference_mid, truth(kKeyframe, kLast + 2)), kClose);
  TrackedFrameConstPtr late;
  while (const TrackedFrameConstPtr next = loop.trackWaiting()) late = next;
  ASSERT_NE(late, nullptr);
  EXPECT_EQ(late->frame->sequence, view(kLast + 2).id);
  EXPECT_LT(distance(late->trajectory.T_reference_mid, truth(kKeyframe, kLast + 2)), kClose);
}

TEST(TrackingAhead, FramesThatWereSeenWellEnoughAreLeftAlone) {
  constexpr int kFew = 4;
  int left_alone = 0;
  int tracked_again = 0;
  for (double threshold = 5.0; threshold < 50.0; threshold *= 1.5) {
    OdometryConfig config = demanding();
    config.keyframe.flow_px = config.keyframe.parallax_px = threshold;
    TrackingLoop loop(config);
    leaveTheView(loop, kFew);
    ASSERT_TRUE(loop.take(keyframeAt(kFew - 1)));
    if (loop.phase() != TrackingPhase::kRevising) continue;  // not worth another look
    const TrackedFrameConstPtr tracked = loop.process(frame(kFew + 1));
    ASSERT_TRUE(tracked->tracked()) << tracked->reason;
    EXPECT_EQ(tracked->provisional, loop.phase() == TrackingPhase::kRevising);
    EXPECT_LT(distance(tracked->trajectory.T_reference_mid, truth(kFew - 1, kFew + 1)), kClose);
    ++(loop.phase() == TrackingPhase::kRevising ? tracked_again : left_alone);
  }
  EXPECT_GT(left_alone, 0);
  EXPECT_GT(tracked_again, 0);
}

TEST(TrackingAhead, WhereNewFramesTakeAllTheTimeTheFirstResultsStand) {
  TrackingLoop loop(demanding());
  leaveTheView(loop, kLast);
  ASSERT_TRUE(loop.take(keyframeAt(kKeyframe)));
  for (int i = kLast + 1; i <= kLast + 4; ++i) {
    ASSERT_EQ(loop.phase(), TrackingPhase::kRevising) << i;
    expectTracked(*loop.process(frame(i)), i);
  }
  EXPECT_EQ(loop.phase(), TrackingPhase::kTracking);
  EXPECT_EQ(loop.waitingFrames(), 0U);
  // The next try would be as much in vain.
  auto next = makeReference(1, 2, kLast + 1, truth(0, kLast + 1));
  next->T_map_keyframe[1] = truth(0, kKeyframe);
  ASSERT_TRUE(loop.take(next));
  EXPECT_EQ(loop.phase(), TrackingPhase::kTracking);
}

TEST(TrackingAhead, IfOneIsLostTheFirstResultsStand) {
  TrackingLoop loop(demanding());
  leaveTheView(loop, kLast);
  cv::Mat1f other_place(view(0).sharp.size());
  cv::randn(other_place, 100.0, 60.0);
  const auto wrong = makeReference(view(kKeyframe), other_place);
  wrong->id = {1, 1, 0};
  wrong->T_map_reference = truth(0, kKeyframe);
  ASSERT_TRUE(loop.take(wrong));
  EXPECT_EQ(loop.trackWaiting(), nullptr);
  EXPECT_EQ(loop.waitingFrames(), 0U);

  const auto right = makeReference(1, 2, kKeyframe, truth(0, kKeyframe));
  right->T_map_keyframe[1] = truth(0, kKeyframe);
  ASSERT_TRUE(loop.take(right, false));
  const TrackedFrameConstPtr next = loop.process(frame(kLast + 1));
  EXPECT_EQ(next->status, TrackingStatus::kTracking) << next->reason;
  EXPECT_LT(distance(next->trajectory.T_reference_mid, truth(kKeyframe, kLast + 1)), kClose);
}

TEST(TrackingAhead, AfterALossNewFramesWait) {
  TrackingLoop loop(demanding());
  leaveTheView(loop, kLast);
  loop.process(elsewhere(0.01));
  ASSERT_TRUE(loop.take(keyframeAt(kKeyframe)));
  EXPECT_NE(loop.phase(), TrackingPhase::kRevising);
  EXPECT_NE(loop.phase(), TrackingPhase::kCatchingUp) << "all have been tried before";
  EXPECT_GT(loop.waitingFrames(), 0U);
}

TEST(TrackingAhead, FramesBeforeTheFirstReferenceHaveToBeCaughtUpWith) {
  TrackingLoop loop{OdometryConfig()};
  for (int i = 1; i <= 3; ++i) loop.process(frame(i));
  ASSERT_TRUE(loop.take(makeReference(1, 0, 0, SE3(), 0)));
  EXPECT_EQ(loop.phase(), TrackingPhase::kCatchingUp);
  EXPECT_NE(loop.phase(), TrackingPhase::kRevising);
  EXPECT_EQ(loop.process(frame(4))->status, TrackingStatus::kInitializing);
  while (loop.trackWaiting()) {
  }
  EXPECT_NE(loop.phase(), TrackingPhase::kCatchingUp);
}

}  // namespace
}  // namespace mba_vo::test::tracking_ahead_test
