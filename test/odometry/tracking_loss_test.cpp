#include <cstdint>
#include <optional>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "mba_vo/odometry/tracking_loop.h"
#include "mba_vo/odometry/tracking_results.h"
#include "odometry/tracking_loop_fixture.h"
#include "support/rendered_room.h"

namespace mba_vo::test::tracking_loss_test {
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
  const SE3 held = loop.T_odom_camera();
  EXPECT_LT(distance(held, last), 0.3) << "it goes on for a moment only";
  EXPECT_TRUE(loop.take(closed(*loop.reference(), "lost for too long")));
  EXPECT_EQ(loop.process(elsewhere(1.2))->status, TrackingStatus::kInitializing);
  EXPECT_EQ(loop.reference(), nullptr);
  EXPECT_LT(distance(loop.T_odom_camera(), held), 1e-12);
  adopt(loop, makeReference(2, 0, 6, someCorrection(), 6));
  const TrackedFrameConstPtr tracked = loop.process(frame(7));
  EXPECT_TRUE(tracked->tracked()) << tracked->reason;
  EXPECT_EQ(tracked->reference.map_id, 2U);
  EXPECT_LT(distance(last.inverse() * loop.T_odom_camera(), truth(6, 7)), kClose) << "from where it was at the hint";
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
  const TrackedFrameConstPtr tracked = loop.process(frame(2), Backlog::kNothing, true);
  EXPECT_EQ(tracked->status, TrackingStatus::kLost);
  EXPECT_TRUE(tracked->blind);
  EXPECT_NE(tracked->reason.find("frozen"), std::string::npos) << tracked->reason;
}

TEST(TrackingLoop, GoesOnFromWhereTheMapperFoundIt) {
  TrackingLoop loop{OdometryConfig()};
  adopt(loop, makeReference(1, 0, 0, SE3(), 0));
  loop.process(frame(1));
  for (int i = 2; i < 6; ++i) {  // somewhere else in the meantime
    EXPECT_EQ(
        loop.process(makeFrame(elsewhere(0.0)->pyramid.level(0).intensity, view(i).mid_exposure_ns, 0.02, 400))->status,
        TrackingStatus::kLost);
  }
  const SE3 T_odom_last = loop.T_odom_camera();
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

constexpr double kTurnInterval = 0.04;  // [s]

/// Turning to the left out of the view of what it saw at first, by 7 degrees from image to image.
SimulatedFrame turning(int index) {
  const SE3 T_world_first = view(0).T_world_mid;
  const auto pose = [&](double t) {
    const Eigen::Vector3d way(0.3 * t, 0.0, 0.0);
    return T_world_first * SE3(Eigen::Quaterniond(Eigen::AngleAxisd(-3.0 * t, Eigen::Vector3d::UnitY())), way);
  };
  return roomSimulator().renderExposure(pose, kTurnInterval * index, 0.01, static_cast<std::uint64_t>(index));
}

TEST(TrackingLoop, TurnsOnWhereItSeesNothingOfTheMap) {
  TrackingLoop loop{OdometryConfig()};
  const SimulatedFrame first = turning(0);
  auto reference = test::makeReference(first, toFloat(first.sharp));
  reference->id = {1, 0, 0};
  reference->T_map_keyframe = {{0, SE3()}};
  reference->cause = ReferenceCause::kMapBegins;
  const Vector6 xi = (first.T_world_start.inverse() * first.T_world_end).log();
  reference->hint = {first.id, first.mid_exposure_ns, {SE3(), xi / first.exposure, first.exposure}};
  adopt(loop, reference);
  int predicted = 0, turned = 0;
  for (int i = 1; i < 20; ++i) {
    const SimulatedFrame seen = turning(i);
    const TrackedFrameConstPtr result = loop.process(makeFrame(seen, seen.exposure));
    const SE3 truth = first.T_world_mid.inverse() * seen.T_world_mid;
    const double error = loop.T_odom_camera().rotation().angularDistance(truth.rotation()) * 180.0 / M_PI;
    EXPECT_LT(error, 1.0) << "degrees, image " << i << ": " << result->reason;
    EXPECT_TRUE(result->hasPose() || result->orientation_only) << "image " << i << ": " << result->reason;
    if (result->hasPose()) {
      EXPECT_LT((loop.T_odom_camera().translation() - truth.translation()).norm(), 0.05) << i;
    }
    if (result->predicted) {
      EXPECT_EQ(result->status, TrackingStatus::kLost);
      EXPECT_EQ(result->publishedStatus(), TrackingStatus::kDegraded);
      expectConsistent(loop, *result);
    }
    predicted += result->predicted ? 1 : 0;
    turned += result->orientation_only ? 1 : 0;
  }
  EXPECT_GE(predicted, 1) << "for a moment its place is known";
  EXPECT_GE(turned, 3) << "and then no more";
  // The mapper knows one before the last by another keyframe: odometry goes on without a jump of its turn.
  const SimulatedFrame last = turning(17);
  auto other = test::makeReference(last, toFloat(last.sharp));
  other->id = {1, 5, 0};
  other->T_map_reference = first.T_world_mid.inverse() * last.T_world_mid;
  other->T_map_keyframe = {{0, SE3()}, {5, other->T_map_reference}};
  other->cause = ReferenceCause::kFoundAgain;
  other->hint = {last.id, last.mid_exposure_ns, {SE3(), xi / first.exposure, last.exposure}};
  adopt(loop, other);
  const SimulatedFrame next = turning(20);
  EXPECT_TRUE(loop.process(makeFrame(next, next.exposure))->tracked());
  const SE3 truth = first.T_world_mid.inverse() * next.T_world_mid;
  EXPECT_LT(loop.T_odom_camera().rotation().angularDistance(truth.rotation()) * 180.0 / M_PI, 1.0);
  EXPECT_LT((loop.T_map_odom() * loop.T_odom_camera()).rotation().angularDistance(truth.rotation()) * 180.0 / M_PI,
            0.5);
}

}  // namespace
}  // namespace mba_vo::test::tracking_loss_test
