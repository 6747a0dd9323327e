// The table of phases, walked through by a tracking loop.
#include <algorithm>
#include <memory>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "mba_vo/odometry/tracking_loop.h"
#include "odometry/tracking_loop_fixture.h"

namespace mba_vo::test::tracking_transitions_test {
namespace {

/// At frame `index`, after one at frame 0 in the same map.
std::shared_ptr<Reference> keyframeAt(int index) {
  auto reference = makeReference(1, 1, index, truth(0, index));
  reference->T_map_keyframe[0] = SE3();
  return reference;
}

/// The image of another place, where frame `index` would have been.
FrameConstPtr strayed(int index) {
  return makeFrame(elsewhere(0.0)->pyramid.level(0).intensity, view(index).mid_exposure_ns, 0.02, view(index).id);
}

FrameConstPtr covered(int index) {
  return makeFrame(cv::Mat1f(240, 376, 90.0F), view(index).mid_exposure_ns, 0.02, view(index).id);
}

void trackUntil(TrackingLoop& loop, int last) {
  adopt(loop, makeReference(1, 0, 0, SE3(), 0));
  for (int i = 1; i <= last; ++i) loop.process(frame(i));
}

void reach(TrackingPhase phase, TrackingLoop& loop) {
  switch (phase) {
    case TrackingPhase::kNoMap:
      break;
    case TrackingPhase::kCatchingUp:
      for (int i = 0; i < 6; ++i) loop.process(frame(i));
      loop.take(makeReference(1, 0, 0, SE3(), 0));
      break;
    case TrackingPhase::kTracking:
      trackUntil(loop, 2);
      break;
    case TrackingPhase::kRevising:
      trackUntil(loop, 9);
      loop.take(keyframeAt(5));
      break;
    case TrackingPhase::kGoingBack:
      trackUntil(loop, 9);
      loop.process(strayed(10));
      loop.take(keyframeAt(5));
      break;
    case TrackingPhase::kLost:
      trackUntil(loop, 2);
      loop.process(strayed(3));
      break;
  }
  ASSERT_EQ(loop.phase(), phase) << toString(phase);
}

class TrackingTransitions : public testing::TestWithParam<TrackingPhase> {
 protected:
  void SetUp() override { reach(GetParam(), loop_); }
  bool hasMap() const { return GetParam() != TrackingPhase::kNoMap; }

  TrackingLoop loop_{demanding()};
};

/// What waited in a hurry is older than where the camera was found: the hurry is over with it.
TEST(TrackingLoop, AfterAHurryItGoesBackAgainForAKeyframe) {
  TrackingLoop loop{demanding()};
  trackUntil(loop, 1);
  for (int i = 2; i <= 3; ++i) loop.process(strayed(i), Backlog::kTooMuch);
  ASSERT_TRUE(loop.isInHurry());
  while (loop.trackWaiting() || loop.hasFailedToLeap()) {
    if (!loop.hasFailedToLeap()) break;
  }
  auto found = makeReference(1, 1, 4, truth(0, 4), 4);
  found->cause = ReferenceCause::kFoundAgain;
  found->T_map_keyframe[0] = SE3();
  ASSERT_TRUE(loop.take(found));
  while (loop.trackWaiting()) {
  }
  EXPECT_FALSE(loop.isInHurry());
  for (int i = 5; i <= 13; ++i) loop.process(frame(i));
  auto next = makeReference(1, 2, 9, truth(0, 9));
  next->T_map_keyframe[1] = truth(0, 4);
  ASSERT_TRUE(loop.take(next));
  EXPECT_EQ(loop.phase(), TrackingPhase::kRevising);
}

TEST_P(TrackingTransitions, AMapThatIsClosedIsLeft) {
  if (!hasMap()) return;
  EXPECT_TRUE(loop_.take(closed(*loop_.reference(), "given up")));
  EXPECT_EQ(loop_.phase(), TrackingPhase::kNoMap);
  EXPECT_EQ(loop_.process(frame(kCount - 1))->status, TrackingStatus::kInitializing);
}

TEST_P(TrackingTransitions, AReset) {
  loop_.reset();
  EXPECT_EQ(loop_.phase(), TrackingPhase::kNoMap);
}

TEST_P(TrackingTransitions, AnotherMapBeginsWithTheFramesThatWait) {
  for (int i = 0; i < 2 && !hasMap(); ++i) loop_.process(frame(i));
  const bool waits = loop_.waitingFrames() > 0;
  EXPECT_TRUE(loop_.take(makeReference(2, 0, 0, SE3(), 0)));
  EXPECT_EQ(loop_.phase(), waits ? TrackingPhase::kCatchingUp : TrackingPhase::kTracking);
  while (loop_.trackWaiting()) {
  }
  EXPECT_NE(loop_.phase(), TrackingPhase::kNoMap);
  EXPECT_EQ(loop_.reference()->id.map_id, 2U);
}

TEST_P(TrackingTransitions, ANewImage) {
  const TrackedFrameConstPtr tracked = loop_.process(frame(11));
  switch (GetParam()) {
    case TrackingPhase::kNoMap:
      EXPECT_EQ(loop_.phase(), TrackingPhase::kNoMap);
      break;
    case TrackingPhase::kCatchingUp:
    case TrackingPhase::kGoingBack:
      EXPECT_EQ(tracked->status, TrackingStatus::kInitializing) << "it waits";
      EXPECT_EQ(loop_.phase(), TrackingPhase::kCatchingUp);
      break;
    case TrackingPhase::kTracking:
    case TrackingPhase::kLost:
      EXPECT_EQ(loop_.phase(), tracked->tracked() ? TrackingPhase::kTracking : TrackingPhase::kLost);
      break;
    case TrackingPhase::kRevising:
      EXPECT_TRUE(tracked->tracked());
      EXPECT_EQ(loop_.phase(), TrackingPhase::kRevising);
      break;
  }
}

TEST_P(TrackingTransitions, WhatWaitsEndsWithTheLastFrameOfIt) {
  while (loop_.trackWaiting(false)) {
  }
  const bool last_was_lost = GetParam() == TrackingPhase::kGoingBack || GetParam() == TrackingPhase::kLost;
  const TrackingPhase expected = last_was_lost ? TrackingPhase::kLost : TrackingPhase::kTracking;
  EXPECT_EQ(loop_.phase(), hasMap() ? expected : TrackingPhase::kNoMap);
}

std::string nameOf(const testing::TestParamInfo<TrackingPhase>& row) {
  std::string name = toString(row.param);
  name.erase(std::remove(name.begin(), name.end(), ' '), name.end());
  return name;
}

INSTANTIATE_TEST_SUITE_P(FromEveryPhase, TrackingTransitions,
                         testing::Values(TrackingPhase::kNoMap, TrackingPhase::kCatchingUp, TrackingPhase::kTracking,
                                         TrackingPhase::kRevising, TrackingPhase::kGoingBack, TrackingPhase::kLost),
                         nameOf);

// Only an image that is tracked tells where the camera is.
TEST(TrackingTransitions, AKeyframeAloneFindsNoLostCamera) {
  TrackingLoop loop(demanding());
  trackUntil(loop, 3);
  loop.process(covered(4));
  ASSERT_EQ(loop.phase(), TrackingPhase::kLost);
  ASSERT_TRUE(loop.take(keyframeAt(3)));
  EXPECT_EQ(loop.phase(), TrackingPhase::kLost);
  EXPECT_TRUE(loop.process(frame(5))->tracked());
  EXPECT_EQ(loop.phase(), TrackingPhase::kTracking);
}

// Even if a keyframe came just before.
TEST(TrackingTransitions, TheHintOfOneThatWasFoundIsUsed) {
  TrackingLoop loop(demanding());
  trackUntil(loop, 3);
  loop.process(covered(4));
  ASSERT_TRUE(loop.take(keyframeAt(3)));
  auto found = makeReference(1, 2, 9, truth(0, 9), 10);
  found->cause = ReferenceCause::kFoundAgain;
  found->T_map_keyframe[1] = truth(0, 3);
  const SE3 before = loop.T_odom_camera();
  ASSERT_TRUE(loop.take(found));
  const TrackedFrameConstPtr tracked = loop.process(frame(11));
  ASSERT_TRUE(tracked->tracked()) << tracked->reason;
  EXPECT_LT(distance(tracked->trajectory.T_reference_mid, truth(9, 11)), kClose);
  EXPECT_LT(distance(loop.T_odom_camera(), before * truth(10, 11)), 2 * kClose) << "odometry goes on from where it was";
}

}  // namespace
}  // namespace mba_vo::test::tracking_transitions_test
