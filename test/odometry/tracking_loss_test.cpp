#include <cstdint>
#include <optional>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "mba_vo/odometry/tracking_loop.h"
#include "mba_vo/odometry/tracking_results.h"
#include "odometry/tracking_loop_fixture.h"
#include "support/rendered_room.h"

namespace mba_vo::test {
namespace {

/// An image that shows nothing.
FrameConstPtr blank(double seconds_later) { return later(cv::Mat1f(240, 376, 90.0F), seconds_later); }

TEST(TrackingLoop, BeginsANewMapWhenItsOwnIsClosedAndOdometryGoesOnFromThere) {
  TrackingLoop loop{OdometryConfig()};
  adopt(loop, makeReference(1, 0, 0, SE3(), 0));
  for (int i = 1; i <= 3; ++i) loop.process(frame(i));
  const SE3 last = loop.T_odom_camera();
  for (double t = 0.0; t < 1.0; t += 0.2) {
    const TrackedFrameConstPtr tracked = loop.process(elsewhere(t));
    EXPECT_EQ(tracked->status, TrackingStatus::kLost) << t;
    EXPECT_FALSE(tracked->reason.empty());
  }
  EXPECT_TRUE(loop.take(closed(*loop.reference(), "lost for too long")));
  EXPECT_EQ(loop.process(elsewhere(1.2))->status, TrackingStatus::kInitializing);
  EXPECT_EQ(loop.reference(), nullptr);
  EXPECT_LT(distance(loop.T_odom_camera(), last), 1e-12);
  adopt(loop, makeReference(2, 0, 6, someCorrection(), 6));
  EXPECT_LT(distance(loop.T_odom_camera(), last), 1e-12);
  const TrackedFrameConstPtr tracked = loop.process(frame(7));
  EXPECT_TRUE(tracked->tracked()) << tracked->reason;
  EXPECT_EQ(tracked->reference.map_id, 2U);
  EXPECT_LT(distance(last.inverse() * loop.T_odom_camera(), truth(6, 7)), kClose);
  expectConsistent(loop, *tracked);
}

TEST(TrackingLoop, PredictsWhileLostAndOnlyThen) {
  TrackingLoop loop{OdometryConfig()};
  adopt(loop, makeReference(1, 0, 0, SE3(), 0));
  const TrackedFrameConstPtr last = loop.process(frame(1));
  const SE3 T_odom_last = loop.T_odom_camera();
  EXPECT_FALSE(loop.predicted_T_odom_camera(last->frame->mid_exposure_ns + 1));
  const TrackedFrameConstPtr covered = loop.process(blank(0.1));
  ASSERT_EQ(covered->status, TrackingStatus::kLost);
  const double dt = 1e-9 * static_cast<double>(covered->frame->mid_exposure_ns - last->frame->mid_exposure_ns);
  const std::optional<SE3> predicted = loop.predicted_T_odom_camera(covered->frame->mid_exposure_ns);
  ASSERT_TRUE(predicted);
  EXPECT_LT(distance(*predicted, T_odom_last * SE3::exp(dt * last->trajectory.velocity)), 1e-9);
  EXPECT_GT(distance(*predicted, T_odom_last), 1e-3);
  EXPECT_LT(distance(loop.T_odom_camera(), T_odom_last), 1e-12);  // that is still where it was last measured
  EXPECT_TRUE(loop.process(later(toFloat(view(2).blurred), 0.2))->tracked());
  EXPECT_FALSE(loop.predicted_T_odom_camera(covered->frame->mid_exposure_ns));
  loop.process(blank(0.3));
  loop.reset();
  EXPECT_FALSE(loop.predicted_T_odom_camera(covered->frame->mid_exposure_ns));
}

TEST(TrackingLoop, ACoveredLensCostsNoMap) {
  TrackingLoop loop{OdometryConfig()};
  const ReferenceConstPtr reference = makeReference(1, 0, 0, SE3(), 0);
  adopt(loop, reference);
  loop.process(frame(1));
  for (double t = 0.0; t < 3.0; t += 0.2) {
    const TrackedFrameConstPtr tracked = loop.process(blank(t));
    EXPECT_EQ(tracked->status, TrackingStatus::kLost);
    EXPECT_TRUE(tracked->blind);
    EXPECT_NE(tracked->reason.find("covered"), std::string::npos) << tracked->reason;
  }
  EXPECT_EQ(loop.reference(), reference);
}

TEST(TrackingLoop, AFrozenImageIsNoMeasurement) {
  TrackingLoop loop{OdometryConfig()};
  adopt(loop, makeReference(1, 0, 0, SE3(), 0));
  EXPECT_TRUE(loop.process(frame(1))->tracked());
  const TrackedFrameConstPtr tracked = loop.process(frame(2), true, true);
  EXPECT_EQ(tracked->status, TrackingStatus::kLost);
  EXPECT_TRUE(tracked->blind);
  EXPECT_NE(tracked->reason.find("frozen"), std::string::npos) << tracked->reason;
}

TEST(TrackingLoop, GoesOnFromWhereTheMapperFoundIt) {
  TrackingLoop loop{OdometryConfig()};
  adopt(loop, makeReference(1, 0, 0, SE3(), 0));
  loop.process(frame(1));
  const SE3 T_odom_last = loop.T_odom_camera();
  for (int i = 2; i < 6; ++i) {  // somewhere else in the meantime
    EXPECT_EQ(
        loop.process(makeFrame(elsewhere(0.0)->pyramid.level(0).intensity, view(i).mid_exposure_ns, 0.02, 400))->status,
        TrackingStatus::kLost);
  }
  // The mapper has seen frame 10 with keyframe 3; frame 11 came in the meantime.
  const TrackedFrameConstPtr lost = loop.process(frame(11));
  auto reference = makeReference(1, 3, 9, truth(0, 9), 10);
  reference->cause = ReferenceCause::kFoundAgain;
  reference->T_map_keyframe[0] = SE3();
  const auto again = adopt(loop, reference);
  const TrackedFrameConstPtr tracked = loop.process(frame(12));
  EXPECT_EQ(tracked->status, TrackingStatus::kTracking) << tracked->reason;
  EXPECT_LT(distance(tracked->trajectory.T_reference_mid, truth(9, 12)), kClose);
  if (!lost->tracked()) {
    EXPECT_EQ(again.size(), 1U) << "the lost frame after the hint is tracked again";
  }
  // The way there was not seen: odometry goes on from where it was, and map -> odom takes the rest.
  EXPECT_LT(distance(loop.T_odom_camera(), T_odom_last * truth(10, 12)), 2 * kClose);
  EXPECT_LT(distance(loop.T_map_odom() * loop.T_odom_camera(), truth(0, 12)), kClose);
}

TEST(TrackingLoop, AfterALossAPoorPoseIsNone) {
  TrackedFrame poor;
  poor.status = TrackingStatus::kDegraded;
  poor.inlier_fraction = 0.7;
  judgeFirstAfterLoss(TrackerConfig(), poor);
  EXPECT_EQ(poor.status, TrackingStatus::kLost);
  TrackedFrame good;
  good.status = TrackingStatus::kTracking;
  good.inlier_fraction = 0.9;
  judgeFirstAfterLoss(TrackerConfig(), good);
  EXPECT_EQ(good.status, TrackingStatus::kDegraded);
  EXPECT_FALSE(good.reason.empty());
}

TEST(TrackingLoop, FindsItselfAgainIfItIsNotLostForLong) {
  TrackingLoop loop{OdometryConfig()};
  adopt(loop, makeReference(1, 0, 3, SE3(), 3));
  loop.process(frame(4));
  EXPECT_EQ(loop.process(makeFrame(cv::Mat1f(240, 376, 90.0F), view(5).mid_exposure_ns, 0.02))->status,
            TrackingStatus::kLost);
  const TrackedFrameConstPtr tracked = loop.process(frame(6));
  EXPECT_EQ(tracked->status, TrackingStatus::kDegraded) << "by prediction alone, so far";
  EXPECT_LT(distance(tracked->trajectory.T_reference_mid, truth(3, 6)), kClose);
  EXPECT_EQ(loop.process(frame(7))->status, TrackingStatus::kTracking);
}

}  // namespace
}  // namespace mba_vo::test
