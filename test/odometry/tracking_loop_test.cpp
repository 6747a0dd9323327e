#include "mba_vo/odometry/tracking_loop.h"

#include <opencv2/imgproc.hpp>

#include <gtest/gtest.h>

#include "mba_vo/odometry/tracking_results.h"
#include "support/rendered_room.h"

namespace mba_vo {
namespace {

constexpr int kFirst = 40;  // of the frames in use
constexpr int kCount = 16;

const std::vector<SimulatedFrame>& views() {
  static const std::vector<SimulatedFrame> views = [] {
    std::vector<SimulatedFrame> v;
    for (int i = 0; i < kCount; ++i) v.push_back(test::roomSimulator().render(kFirst + i));
    return v;
  }();
  return views;
}

const SimulatedFrame& view(int index) { return views().at(static_cast<std::size_t>(index)); }
FrameConstPtr frame(int index) { return test::makeFrame(view(index), view(index).exposure); }

SE3 truth(int from, int to) { return view(from).T_world_mid.inverse() * view(to).T_world_mid; }

ExposureTrajectory trueTrajectory(int reference, int index) {
  const SimulatedFrame& v = view(index);
  return {truth(reference, index), (v.T_world_start.inverse() * v.T_world_end).log() / v.exposure, v.exposure};
}

/// Reference with true depths about a frame, at `T_map_reference`; the hint tells of frame `hint`.
std::shared_ptr<Reference> makeReference(MapId map, KeyframeId keyframe, int index, const SE3& T_map_reference,
                                         std::optional<int> hint = {}) {
  auto reference = test::makeReference(view(index), test::toFloat(view(index).sharp));
  reference->id = {map, keyframe, 0};
  reference->T_map_reference = T_map_reference;
  reference->T_map_keyframe = {{keyframe, T_map_reference}};
  if (hint) reference->hint = {view(*hint).id, view(*hint).mid_exposure_ns, trueTrajectory(index, *hint)};
  return reference;
}

/// Takes the reference and tracks all that waited for it.
std::vector<TrackedFrameConstPtr> adopt(TrackingLoop& loop, const ReferenceConstPtr& reference) {
  std::vector<TrackedFrameConstPtr> late;
  if (!loop.take(reference)) return late;
  while (TrackedFrameConstPtr tracked = loop.trackWaiting()) late.push_back(std::move(tracked));
  return late;
}

SE3 someCorrection() {
  Vector6 correction;
  correction << 0.3, -0.2, 0.1, 0.05, 0.2, -0.1;
  return SE3::exp(correction);
}

double distance(const SE3& a, const SE3& b) { return (a.inverse() * b).log().norm(); }

/// 5 mm and 5 mrad: about a pixel.
constexpr double kClose = 5e-3;

FrameConstPtr later(const cv::Mat1f& image, double seconds_later) {
  return test::makeFrame(image, view(kCount - 1).mid_exposure_ns + std::llround(1e9 * seconds_later), 0.02, 500);
}

/// An image that shows nothing.
FrameConstPtr blank(double seconds_later) { return later(cv::Mat1f(240, 376, 90.0F), seconds_later); }

/// An image of another place; no two are the same.
FrameConstPtr elsewhere(double seconds_later) {
  static int seed = 0;
  cv::Mat1f image(240, 376);
  cv::RNG(static_cast<std::uint64_t>(++seed)).fill(image, cv::RNG::NORMAL, 100.0, 60.0);
  cv::blur(image, image, {9, 9});
  return later(test::scaled(image, 4.0, -300.0), seconds_later);
}

/// Asks for keyframes early, so that a few frames are enough to leave a reference's view.
OdometryConfig demanding() {
  OdometryConfig config;
  config.keyframe.flow_px = 5.0;
  config.keyframe.parallax_px = 5.0;
  config.keyframe.patience = 0.0;
  return config;
}

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
    tracked = loop.process(test::makeFrame(view(i), std::nullopt));
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

/// T_map_odom T_odom_camera is where the camera is in the map, by its reference.
void expectConsistent(const TrackingLoop& loop, const TrackedFrame& tracked) {
  const SE3 T_map_camera = loop.reference()->T_map_reference * tracked.trajectory.T_reference_mid;
  EXPECT_LT(distance(loop.T_map_odom() * loop.T_odom_camera(), T_map_camera), 1e-9);
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

TEST(TrackingLoop, BeginsANewMapAfterBeingLostAndOdometryGoesOnFromThere) {
  const OdometryConfig config;
  TrackingLoop loop(config);
  adopt(loop, makeReference(1, 0, 0, SE3(), 0));
  for (int i = 1; i <= 3; ++i) loop.process(frame(i));
  const SE3 last = loop.T_odom_camera();
  for (double t = 0.0; t < config.mapper.restart_after_lost - 0.01; t += 0.2) {
    const TrackedFrameConstPtr tracked = loop.process(elsewhere(t));
    EXPECT_EQ(tracked->status, TrackingStatus::kLost) << t;
    EXPECT_FALSE(tracked->reason.empty());
  }
  EXPECT_EQ(loop.process(elsewhere(config.mapper.restart_after_lost))->status, TrackingStatus::kLost);
  EXPECT_EQ(loop.process(elsewhere(config.mapper.restart_after_lost + 0.2))->status, TrackingStatus::kInitializing);
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

TEST(TrackingLoop, AFrozenImageIsNoMeasurementForLong) {
  TrackingLoop loop{OdometryConfig()};
  adopt(loop, makeReference(1, 0, 0, SE3(), 0));
  EXPECT_TRUE(loop.process(frame(1))->tracked());
  const cv::Mat1f frozen = test::toFloat(view(2).blurred);
  const std::int64_t since = view(2).mid_exposure_ns;
  for (int i = 0; i < 10; ++i) {
    const TrackedFrameConstPtr tracked = loop.process(test::makeFrame(frozen, since + i * 33000000LL, 0.02, 300));
    EXPECT_EQ(tracked->tracked(), i < 5) << "a recorder may write an image twice; " << i;
    EXPECT_EQ(tracked->blind, i >= 5);
    if (i > 0 && i < 5) {
      EXPECT_EQ(tracked->status, TrackingStatus::kDegraded) << "the pose is that of the first";
    }
  }
}

TEST(TrackingLoop, GoesOnFromWhereTheMapperFoundIt) {
  TrackingLoop loop{OdometryConfig()};
  adopt(loop, makeReference(1, 0, 0, SE3(), 0));
  loop.process(frame(1));
  const SE3 T_odom_first = loop.T_odom_camera() * truth(1, 0);
  for (int i = 2; i < 6; ++i) {  // somewhere else in the meantime
    EXPECT_EQ(
        loop.process(test::makeFrame(elsewhere(0.0)->pyramid.level(0).intensity, view(i).mid_exposure_ns, 0.02, 400))
            ->status,
        TrackingStatus::kLost);
  }
  // The mapper has seen frame 10 with keyframe 3; frame 11 came in the meantime.
  const TrackedFrameConstPtr lost = loop.process(frame(11));
  auto reference = makeReference(1, 3, 9, truth(0, 9), 10);
  reference->T_map_keyframe[0] = SE3();
  const auto again = adopt(loop, reference);
  const TrackedFrameConstPtr tracked = loop.process(frame(12));
  EXPECT_EQ(tracked->status, TrackingStatus::kTracking) << tracked->reason;
  EXPECT_LT(distance(tracked->trajectory.T_reference_mid, truth(9, 12)), kClose);
  if (!lost->tracked()) {
    EXPECT_EQ(again.size(), 1U) << "the lost frame after the hint is tracked again";
  }
  // The way there was not seen, but it is known now: odometry is where the map says.
  EXPECT_LT(distance(loop.T_odom_camera(), T_odom_first * truth(0, 12)), 2 * kClose);
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

TEST(TrackingLoop, LeavesAMapThatWasGivenUp) {
  TrackingLoop loop{OdometryConfig()};
  adopt(loop, makeReference(1, 0, 0, SE3(), 0));
  loop.process(frame(1));
  auto other = std::make_shared<Reference>(*makeReference(7, 0, 0, SE3()));
  other->withdrawn = "another one";
  EXPECT_FALSE(loop.take(other));
  EXPECT_NE(loop.reference(), nullptr);
  auto withdrawn = std::make_shared<Reference>(*makeReference(1, 0, 0, SE3()));
  withdrawn->withdrawn = "map 1 was given up";
  EXPECT_TRUE(loop.take(withdrawn));
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
    const TrackedFrameConstPtr tracked = loop.process(test::makeFrame(
        test::scaled(test::toFloat(view(i).blurred), gain), view(i).mid_exposure_ns, view(i).exposure, view(i).id));
    ASSERT_TRUE(tracked->tracked()) << i << ": " << tracked->reason;
    EXPECT_NEAR(tracked->brightness.a, std::log(gain), 0.1);
    EXPECT_LT(distance(tracked->trajectory.T_reference_mid, truth(0, i)), 2 * kClose) << i;
  }
}

TEST(TrackingLoop, FindsItselfAgainIfItIsNotLostForLong) {
  TrackingLoop loop{OdometryConfig()};
  adopt(loop, makeReference(1, 0, 3, SE3(), 3));
  loop.process(frame(4));
  EXPECT_EQ(loop.process(test::makeFrame(cv::Mat1f(240, 376, 90.0F), view(5).mid_exposure_ns, 0.02))->status,
            TrackingStatus::kLost);
  const TrackedFrameConstPtr tracked = loop.process(frame(6));
  EXPECT_EQ(tracked->status, TrackingStatus::kDegraded) << "by prediction alone, so far";
  EXPECT_LT(distance(tracked->trajectory.T_reference_mid, truth(3, 6)), kClose);
  EXPECT_EQ(loop.process(frame(7))->status, TrackingStatus::kTracking);
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
  while (loop.trackWaiting()) {
  }
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
  const TrackedFrameConstPtr tracked =
      loop.process(test::makeFrame(test::scaled(test::toFloat(last.blurred), 1.0, 0.1),
                                   last.mid_exposure_ns + std::llround(0.6e9), last.exposure, 500));
  ASSERT_TRUE(tracked->tracked()) << tracked->reason;
  EXPECT_FALSE(tracked->provisional);
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
}  // namespace mba_vo
