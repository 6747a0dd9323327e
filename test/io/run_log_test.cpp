#include "mba_vo/io/run_log.h"

#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mba_vo::run_log_test {
namespace {

using testing::HasSubstr;

FrameConstPtr frameNumber(std::uint64_t sequence) {
  auto frame = std::make_shared<Frame>();
  frame->sequence = sequence;
  frame->mid_exposure_ns = static_cast<std::int64_t>(sequence) * 30000000;
  return frame;
}

TrackedFrameConstPtr tracked(std::uint64_t sequence, TrackingStatus status, const std::string& reason = "") {
  auto result = std::make_shared<TrackedFrame>();
  result->frame = frameNumber(sequence);
  result->status = status;
  result->reason = reason;
  result->points_used = 400;
  result->measures.blur_length_px = 7.0;
  result->tracking_ms = 5.0;
  return result;
}

/// One image's first result.
OdometryResult resultOf(const TrackedFrameConstPtr& frame, const std::string& warning = "") {
  PublishedImage image;
  image.step.kind = TrackerStep::Kind::kImage;
  image.step.sequence = frame->frame->sequence;
  image.step.mid_exposure_ns = frame->frame->mid_exposure_ns;
  image.step.arrival = 2.0;
  image.step.reason = warning;
  image.step.message.tracked = frame;
  image.step.T_odom_camera = SE3::exp((Vector6() << 1.0, 2.0, 3.0, 0.1, 0.2, 0.3).finished());
  image.step.T_map_odom = SE3::exp((Vector6() << 4.0, 5.0, 6.0, 0.3, 0.2, 0.1).finished());
  image.published = 2.01;
  return {{image}, {}, {}, 1.0};
}

TrajectoryEntry pose(std::uint64_t sequence, MapId map) {
  TrajectoryEntry entry;
  entry.frame_sequence = sequence;
  entry.map_id = map;
  return entry;
}

/// Frames 0..4: initialising, initialising, tracked, lost, tracked.
RunLog fiveFrames() {
  RunLog log;
  log.add(resultOf(tracked(0, TrackingStatus::kInitializing, "no map")));
  log.add(resultOf(tracked(1, TrackingStatus::kInitializing, "no map")));
  log.add(resultOf(tracked(2, TrackingStatus::kTracking), "exposure odd"));
  log.add(resultOf(tracked(3, TrackingStatus::kLost, "too few points")));
  log.add(resultOf(tracked(4, TrackingStatus::kDegraded, "few points")));
  return log;
}

TEST(RunLog, FinalStatusFollowsTheFinalTrajectory) {
  RunLog log = fiveFrames();
  log.settle({pose(1, 1), pose(2, 1), pose(4, 1)});
  const auto& frames = log.frames();
  ASSERT_EQ(frames.size(), 5U);
  EXPECT_EQ(frames[0].status, "INITIALIZING");
  EXPECT_EQ(frames[0].reason, "no map");
  EXPECT_FALSE(frames[0].hasPose());
  EXPECT_FALSE(frames[0].blur_length_px.has_value());
  EXPECT_EQ(frames[1].status, "TRACKING");
  EXPECT_EQ(frames[1].reason, "tracked backwards after initialisation");
  EXPECT_EQ(frames[1].map, 1U);
  EXPECT_EQ(frames[2].status, "TRACKING");
  EXPECT_EQ(frames[2].reason, "exposure odd");
  EXPECT_EQ(frames[2].points_used, 400);
  EXPECT_EQ(frames[3].status, "LOST");
  EXPECT_EQ(frames[4].status, "DEGRADED");
  const FrameCounts counts = countFrames(frames);
  EXPECT_EQ(counts.frames, 5U);
  EXPECT_EQ(counts.tracked, 3U);
  EXPECT_EQ(counts.dropped, 2U);
  EXPECT_EQ(counts.dropped_after_initialization, 1U);
  EXPECT_EQ(counts.maps, 1U);
}

TEST(RunLog, PoseGivenUpByTheMapperCountsAsLost) {
  RunLog log = fiveFrames();
  log.settle({pose(2, 1)});
  EXPECT_EQ(log.frames()[4].status, "LOST");
  EXPECT_THAT(log.frames()[4].reason, HasSubstr("was DEGRADED"));
  EXPECT_EQ(countFrames(log.frames()).dropped_after_initialization, 2U);
}

TEST(RunLog, FramesTrackedLaterHaveTheStatusOfTheirPose) {
  RunLog log = fiveFrames();
  TrajectoryEntry doubtful = pose(1, 1);
  doubtful.degraded = true;
  log.settle({pose(0, 1), doubtful, pose(2, 1), pose(4, 1)});
  EXPECT_EQ(log.frames()[0].status, "TRACKING");
  EXPECT_EQ(log.frames()[1].status, "DEGRADED");
}

TEST(RunLog, NothingTrackedIsAllDropped) {
  RunLog log = fiveFrames();
  log.settle({});
  const FrameCounts counts = countFrames(log.frames());
  EXPECT_EQ(counts.tracked, 0U);
  EXPECT_EQ(counts.dropped, 5U);
  EXPECT_EQ(counts.dropped_after_initialization, 0U);
}

TEST(RunLog, LateResultsReplaceTheFirstOnes) {
  RunLog log;
  log.add(resultOf(tracked(0, TrackingStatus::kInitializing, "no map")));
  OdometryResult next = resultOf(tracked(1, TrackingStatus::kTracking));
  next.late = {tracked(0, TrackingStatus::kTracking)};
  log.add(next);
  log.settle({pose(0, 1), pose(1, 1)});
  ASSERT_EQ(log.frames().size(), 2U);
  EXPECT_EQ(log.frames()[0].status, "TRACKING");
  EXPECT_EQ(log.frames()[0].reason, "had to wait for a reference");
  EXPECT_EQ(log.frames()[0].blur_length_px, 7.0);
  EXPECT_DOUBLE_EQ(log.frames()[0].tracking_ms, 10.0);
}

TEST(RunLog, KeepsWhatWasPublishedWhateverComesLater) {
  RunLog log = fiveFrames();
  OdometryResult late;
  late.late = {tracked(1, TrackingStatus::kTracking), tracked(3, TrackingStatus::kTracking)};
  log.add(late);
  log.settle({pose(0, 1), pose(1, 1), pose(3, 1)});
  const auto& frames = log.frames();
  EXPECT_EQ(frames[1].status, "TRACKING");
  EXPECT_EQ(frames[1].online_status, "INITIALIZING");
  EXPECT_FALSE(frames[1].published);
  EXPECT_FALSE(frames[3].online) << "it was lost when it came";
  EXPECT_EQ(frames[2].online_status, "TRACKING");
  EXPECT_EQ(frames[2].published, 2.01);
  ASSERT_TRUE(frames[2].online);
  const OdometryResult first = resultOf(tracked(2, TrackingStatus::kTracking));
  const TrackerStep& step = first.images.front().step;
  EXPECT_LT((frames[2].online->T_odom_camera.inverse() * step.T_odom_camera).log().norm(), 1e-12);
  EXPECT_LT((frames[2].online->in_map.T_reference_mid.inverse() * step.T_map_odom * step.T_odom_camera).log().norm(),
            1e-12);
}

TEST(RunLog, AnOrientationAloneIsNoPose) {
  auto turned = std::make_shared<TrackedFrame>(*tracked(0, TrackingStatus::kInitializing));
  turned->orientation_only = true;
  RunLog log;
  log.add(resultOf(turned));
  EXPECT_EQ(log.frames()[0].online_status, "ORIENTATION");
  EXPECT_TRUE(log.frames()[0].published);
  EXPECT_FALSE(log.frames()[0].online);
}

TEST(RunLog, KeepsMessagesKeyframesAndRejectedImages) {
  MapperOutput first;
  first.message = "first";
  first.keyframe = KeyframeReport{};
  MapperOutput second;
  second.message = "second";
  RunLog log;
  OdometryResult result = resultOf(tracked(0, TrackingStatus::kTracking));
  result.mapping = {first, second};
  log.add(result);
  PublishedImage rejected;
  rejected.step.kind = TrackerStep::Kind::kRejected;
  rejected.step.sequence = 1;
  rejected.step.reason = "stamp repeats";
  log.add({{rejected}, {}, {}, 0.0});
  log.settle({pose(0, 1)});
  EXPECT_EQ(log.keyframes().size(), 1U);
  EXPECT_EQ(log.frames()[0].message, "first; second");
  EXPECT_EQ(log.frames()[1].status, "REJECTED");
  EXPECT_EQ(log.frames()[1].reason, "stamp repeats");
  EXPECT_EQ(countFrames(log.frames()).rejected, 1U);
}

TEST(RunLog, ARepeatedImageIsNeitherTrackedNorDropped) {
  RunLog log;
  log.add(resultOf(tracked(0, TrackingStatus::kTracking)));
  PublishedImage again;
  again.step.kind = TrackerStep::Kind::kRepeated;
  again.step.sequence = 1;
  again.step.reason = "repeats image 0";
  log.add({{again}, {}, {}, 0.0});
  log.settle({pose(0, 1)});
  const FrameRecord& record = log.frames()[1];
  EXPECT_EQ(record.status, "REPEATED");
  EXPECT_EQ(record.online_status, "REPEATED");
  EXPECT_EQ(record.reason, "repeats image 0");
  EXPECT_FALSE(record.hasPose());
  EXPECT_FALSE(record.online);
  const FrameCounts counts = countFrames(log.frames());
  EXPECT_EQ(counts.repeated, 1U);
  EXPECT_EQ(counts.tracked, 1U);
  EXPECT_EQ(counts.dropped, 0U);
  EXPECT_EQ(counts.dropped_after_initialization, 0U);
}

}  // namespace
}  // namespace mba_vo::run_log_test
