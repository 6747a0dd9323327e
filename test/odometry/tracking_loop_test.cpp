#include "mba_vo/odometry/tracking_loop.h"

#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "odometry/tracking_loop_fixture.h"
#include "support/rendered_room.h"

namespace mba_vo::test::tracking_loop_test {
namespace {

TEST(TrackingLoop, AnUnknownExposureIsLearntAndTheFramesCarryIt) {
  TrackingLoop loop{OdometryConfig()};
  const double exposure = view(0).exposure;
  TrackedFrameConstPtr tracked;
  for (int i = 0; i < kCount; ++i) {
    // A reference from every fourth frame, so that none leaves the view.
    if (i % 4 == 0) {
      const auto reference = makeReference(1, static_cast<KeyframeId>(i), i, truth(0, i), 0);
      if (i > 0) reference->T_map_keyframe[static_cast<KeyframeId>(i - 4)] = truth(0, i - 4);
      ASSERT_TRUE(loop.take(reference));
    }
    if (i == 0) continue;
    tracked = loop.process(makeFrame(view(i), std::nullopt));
    ASSERT_EQ(tracked->status, TrackingStatus::kTracking) << tracked->reason;
    if (!tracked->frame->exposure) continue;
    EXPECT_NEAR(*tracked->frame->exposure, exposure, 0.1 * exposure);
    EXPECT_TRUE(tracked->exposure_estimate.used);
  }
  EXPECT_TRUE(tracked->frame->exposure);
}

TEST(TrackingLoop, FramesBeforeThereIsAMapAreInitializing) {
  TrackingLoop loop{OdometryConfig()};
  const TrackedFrameConstPtr tracked = loop.process(frame(0));
  ASSERT_NE(tracked, nullptr);
  EXPECT_EQ(tracked->status, TrackingStatus::kInitializing);
  EXPECT_FALSE(tracked->reason.empty());
  EXPECT_EQ(tracked->frame->sequence, view(0).id);
  EXPECT_EQ(loop.reference(), nullptr);
  EXPECT_EQ(distance(loop.T_odom_camera(), SE3()), 0.0);
  EXPECT_EQ(distance(loop.T_map_odom(), SE3()), 0.0);
}

TEST(TrackingLoop, WithoutAMapTheOdometryTurnsWithTheCamera) {
  TrackingLoop loop{OdometryConfig()};
  std::vector<SE3> odometry;
  for (int i = 0; i <= 5; ++i) {
    const TrackedFrameConstPtr tracked = loop.process(frame(i));
    EXPECT_EQ(tracked->status, TrackingStatus::kInitializing);
    EXPECT_TRUE(tracked->orientation_only);
    EXPECT_GT(tracked->covariance(0, 0), 1e5) << "there is no position";
    odometry.push_back(loop.T_odom_camera());
    EXPECT_EQ(odometry.back().translation().norm(), 0.0);
    // The camera moves too, which is taken for rotation where it looks like one.
    EXPECT_LT(odometry.back().rotation().angularDistance(truth(0, i).rotation()), 0.02) << "frame " << i;
  }
  // With a map it goes on from where it was at the frame that the hint is about.
  ASSERT_TRUE(loop.take(makeReference(1, 0, 0, someCorrection(), 2)));
  const TrackedFrameConstPtr late = loop.trackWaiting();
  ASSERT_TRUE(late && late->tracked());
  EXPECT_FALSE(late->orientation_only);
  EXPECT_LT(distance(loop.T_odom_camera(), odometry.at(2) * truth(2, 3)), kClose);
}

TEST(TrackingLoop, AReferenceWithoutAHintIsOfNoUseToBeginWith) {
  TrackingLoop loop{OdometryConfig()};
  loop.process(frame(0));
  EXPECT_TRUE(adopt(loop, makeReference(1, 0, 0, SE3())).empty());
  EXPECT_EQ(loop.reference(), nullptr);
  EXPECT_EQ(loop.process(frame(1))->status, TrackingStatus::kInitializing);
}

TEST(TrackingLoop, OdometryDoesNotJumpWhenTheMapIsCorrected) {
  TrackingLoop loop{OdometryConfig()};
  adopt(loop, makeReference(1, 0, 0, SE3(), 0));
  loop.process(frame(1));
  loop.process(frame(2));
  expectConsistent(loop, *loop.process(frame(3)));
  SE3 last = loop.T_odom_camera();
  const SE3 map_before = loop.T_map_odom();

  // A new keyframe (frame 2), and everything in the map has moved.
  const SE3 correction = someCorrection();
  auto next = makeReference(1, 1, 2, correction * truth(0, 2));
  next->T_map_keyframe[0] = correction;
  adopt(loop, next);
  EXPECT_EQ(loop.reference(), next);
  EXPECT_LT(distance(loop.T_odom_camera(), last), 1e-12);
  EXPECT_LT(distance(loop.T_map_odom(), correction * map_before), 1e-9);
  for (int i = 4; i <= 8; ++i) {
    const TrackedFrameConstPtr tracked = loop.process(frame(i));
    EXPECT_EQ(tracked->status, TrackingStatus::kTracking) << tracked->reason;
    EXPECT_EQ(tracked->reference.keyframe_id, 1U);
    EXPECT_LT(distance(tracked->trajectory.T_reference_mid, truth(2, i)), kClose);
    EXPECT_LT(distance(last.inverse() * loop.T_odom_camera(), truth(i - 1, i)), 2 * kClose) << "frame " << i;
    expectConsistent(loop, *tracked);
    last = loop.T_odom_camera();
  }
}

TEST(TrackingLoop, GoesOnWhenItsKeyframeHasLeftTheWindow) {
  TrackingLoop loop{OdometryConfig()};
  adopt(loop, makeReference(1, 0, 0, someCorrection(), 0));
  for (int i = 1; i <= 3; ++i) loop.process(frame(i));
  const SE3 last = loop.T_odom_camera();
  adopt(loop, makeReference(1, 5, 3, someCorrection() * truth(0, 3)));  // does not know keyframe 0
  EXPECT_LT(distance(loop.T_odom_camera(), last), 1e-12);
  const TrackedFrameConstPtr tracked = loop.process(frame(4));
  EXPECT_EQ(tracked->status, TrackingStatus::kTracking) << tracked->reason;
  EXPECT_LT(distance(last.inverse() * loop.T_odom_camera(), truth(3, 4)), 2 * kClose);
  expectConsistent(loop, *tracked);
}

TEST(TrackingLoop, AReferenceOfAnotherMapWithoutAHintChangesNothing) {
  TrackingLoop loop{OdometryConfig()};
  const ReferenceConstPtr first = makeReference(1, 0, 0, SE3(), 0);
  adopt(loop, first);
  loop.process(frame(1));
  EXPECT_TRUE(adopt(loop, makeReference(2, 0, 1, someCorrection())).empty());
  EXPECT_EQ(loop.reference(), first);
  EXPECT_EQ(loop.process(frame(2))->reference.map_id, 1U);
}

TEST(TrackingLoop, LeavesAMapThatWasGivenUp) {
  TrackingLoop loop{OdometryConfig()};
  adopt(loop, makeReference(1, 0, 0, SE3(), 0));
  loop.process(frame(1));
  auto other = std::make_shared<Reference>(*makeReference(7, 0, 0, SE3()));
  other->cause = ReferenceCause::kMapClosed;
  other->closed_because = "another one";
  EXPECT_FALSE(loop.take(other));
  EXPECT_NE(loop.reference(), nullptr);
  EXPECT_TRUE(loop.take(closed(*loop.reference(), "map 1 was given up")));
  EXPECT_EQ(loop.reference(), nullptr);
  const TrackedFrameConstPtr tracked = loop.process(frame(2));
  EXPECT_EQ(tracked->status, TrackingStatus::kInitializing);
  EXPECT_EQ(tracked->reason, "map 1 was given up");
}

TEST(TrackingLoop, PosesOfADoubtfulMapAreDegraded) {
  TrackingLoop loop{OdometryConfig()};
  auto reference = std::make_shared<Reference>(*makeReference(1, 0, 0, SE3(), 0));
  reference->doubt = "the map contradicts itself";
  adopt(loop, reference);
  const TrackedFrameConstPtr tracked = loop.process(frame(1));
  EXPECT_EQ(tracked->status, TrackingStatus::kDegraded);
  EXPECT_EQ(tracked->reason, "the map contradicts itself");
}

TEST(TrackingLoop, FollowsAChangeOfBrightnessByEight) {
  TrackingLoop loop{OdometryConfig()};
  adopt(loop, makeReference(1, 0, 0, SE3(), 0));
  loop.process(frame(1));
  for (int i = 2; i < 6; ++i) {
    const double gain = i < 4 ? 0.125 : 1.0;
    const TrackedFrameConstPtr tracked = loop.process(
        makeFrame(scaled(toFloat(view(i).blurred), gain), view(i).mid_exposure_ns, view(i).exposure, view(i).id));
    ASSERT_TRUE(tracked->tracked()) << i << ": " << tracked->reason;
    EXPECT_NEAR(tracked->brightness.a, std::log(gain), 0.1);
    EXPECT_LT(distance(tracked->trajectory.T_reference_mid, truth(0, i)), 2 * kClose) << i;
  }
}

TEST(TrackingLoop, ResetForgetsReferenceAndWaitingFrames) {
  TrackingLoop loop{OdometryConfig()};
  loop.process(frame(0));
  adopt(loop, makeReference(1, 0, 0, SE3(), 0));
  loop.process(frame(1));
  loop.reset();
  EXPECT_EQ(loop.reference(), nullptr);
  EXPECT_EQ(distance(loop.T_odom_camera(), SE3()), 0.0);
  EXPECT_EQ(loop.process(frame(2))->status, TrackingStatus::kInitializing);
  loop.reset();
  EXPECT_TRUE(adopt(loop, makeReference(2, 0, 0, SE3(), 0)).empty());
}

TEST(TrackingLoop, AsksForAKeyframeWhenTheViewHasChanged) {
  OdometryConfig config = demanding();
  TrackingLoop eager(config);
  adopt(eager, makeReference(1, 0, 0, SE3(), 0));
  bool asked = false;
  for (int i = 1; i <= 6; ++i) asked |= eager.process(frame(i))->keyframe_requested;
  EXPECT_TRUE(asked);
  config.keyframe.flow_px = config.keyframe.parallax_px = 1000.0;
  config.keyframe.min_visible_fraction = 0.0;
  TrackingLoop patient(config);
  adopt(patient, makeReference(1, 0, 0, SE3(), 0));
  for (int i = 1; i <= 6; ++i) EXPECT_FALSE(patient.process(frame(i))->keyframe_requested);
}

}  // namespace
}  // namespace mba_vo::test::tracking_loop_test
