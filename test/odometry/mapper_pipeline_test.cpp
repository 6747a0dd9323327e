#include "mba_vo/odometry/mapper_pipeline.h"

#include <algorithm>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "mapping/follower.h"
#include "mapping/mapper_fixture.h"

namespace mba_vo::test::mapper_pipeline_test {
namespace {

constexpr std::size_t kQueueBytes = 500000000;

TrackerMessage message(std::uint64_t session, const TrackedFrameConstPtr& tracked, bool keep_map = true) {
  return {session, keep_map, false, {}, tracked};
}

/// Steps until nothing is left; those that took in a frame.
std::vector<MapperStep> drain(MapperPipeline& pipeline) {
  std::vector<MapperStep> steps;
  while (const std::optional<MapperStep> step = pipeline.step()) {
    if (step->kind == MapperStep::Kind::kFrame) steps.push_back(*step);
  }
  return steps;
}

/// Feeds images until there is a map; its first reference.
MapperMessage begin(MapperPipeline& pipeline, std::uint64_t session, double later = 0.0, bool keep_map = true) {
  for (const FrameConstPtr& frame : frames()) {
    pipeline.addFrame(message(session, report(shifted(frame, later), TrackingStatus::kInitializing), keep_map));
    for (const MapperStep& step : drain(pipeline)) {
      if (step.reference.reference) return step.reference;
    }
  }
  return {};
}

TEST(MapperPipeline, ReferencesAreForTheSessionOfTheirFrames) {
  MapperPipeline pipeline(config(), kQueueBytes);
  const MapperMessage reference = begin(pipeline, 5);
  ASSERT_NE(reference.reference, nullptr);
  EXPECT_EQ(reference.session, 5U);
  EXPECT_EQ(reference.reference->cause, ReferenceCause::kMapBegins);
  EXPECT_FALSE(pipeline.step());
}

TEST(MapperPipeline, ATrackerThatBeganAnewWantsANewMapAndOneThatWasRestartedDoesNot) {
  MapperPipeline pipeline(config(), kQueueBytes);
  ASSERT_NE(begin(pipeline, 5).reference, nullptr);
  pipeline.addFrame(message(6, report(shifted(frames()[0], 5.0), TrackingStatus::kInitializing)));
  std::vector<MapperStep> steps = drain(pipeline);
  ASSERT_EQ(steps.size(), 1U);
  EXPECT_FALSE(steps[0].was_reset);
  EXPECT_NE(pipeline.mapper().currentReference(), nullptr);
  pipeline.addFrame(message(7, report(shifted(frames()[0], 6.0), TrackingStatus::kInitializing), false));
  steps = drain(pipeline);
  ASSERT_EQ(steps.size(), 1U);
  EXPECT_TRUE(steps[0].was_reset);
  EXPECT_EQ(pipeline.mapper().currentReference(), nullptr);
}

TEST(MapperPipeline, AfterAFailureTheTrackerIsToldToLeaveTheMap) {
  MapperPipeline pipeline(config(), kQueueBytes);
  EXPECT_EQ(pipeline.recover("nothing yet").reference, nullptr);
  const MapperMessage first = begin(pipeline, 5);
  ASSERT_NE(first.reference, nullptr);
  const MapperMessage closed = pipeline.recover("out of memory");
  ASSERT_NE(closed.reference, nullptr);
  EXPECT_EQ(closed.session, 5U);
  EXPECT_EQ(closed.reference->cause, ReferenceCause::kMapClosed);
  EXPECT_EQ(closed.reference->closed_because, "out of memory");
  EXPECT_EQ(closed.reference->id.map_id, first.reference->id.map_id);
  const MapperMessage next = begin(pipeline, 5, 10.0);
  ASSERT_NE(next.reference, nullptr);
  EXPECT_GT(next.reference->id.map_id, first.reference->id.map_id);
}

/// The poses of all frames after following the camera for some keyframes, with or without asking for the trajectory.
std::vector<SE3> posesAfter(bool asking) {
  Mapper mapper(config());
  Follower follower(mapper, frames());
  std::vector<SE3> poses;
  for (int i = 0; i < 3; ++i) {
    follower.toNextKeyframe();
    if (asking) {
      EXPECT_FALSE(mapper.finishedTrajectory().empty());
    }
    mapper.doDeferredWork();
  }
  for (const TrajectoryEntry& entry : mapper.trajectory()) poses.push_back(entry.trajectory.T_reference_mid);
  return poses;
}

TEST(MapperPipeline, AskingForTheTrajectoryChangesNothing) {
  const std::vector<SE3> asked = posesAfter(true);
  const std::vector<SE3> undisturbed = posesAfter(false);
  ASSERT_EQ(asked.size(), undisturbed.size());
  for (std::size_t i = 0; i < asked.size(); ++i) EXPECT_EQ(asked[i].log(), undisturbed[i].log()) << i;
}

TEST(MapperPipeline, FramesComeBetweenThePiecesOfAKeyframe) {
  MapperPipeline pipeline(config(), kQueueBytes);
  const MapperMessage first = begin(pipeline, 5);
  ASSERT_NE(first.reference, nullptr);
  auto next = std::find_if(frames().begin(), frames().end(), [&](const FrameConstPtr& frame) {
    return frame->mid_exposure_ns > first.reference->hint->mid_exposure_ns;
  });
  double angle = 0.0;
  const auto addFrame = [&] {
    ASSERT_NE(next, frames().end());
    Vector6 turn = Vector6::Zero();
    turn(4) = angle += 0.1;
    pipeline.addFrame(message(5, report(*next++, TrackingStatus::kTracking, first.reference->id, SE3::exp(turn))));
  };
  std::optional<MapperStep> step;
  while (!step || !step->output.inserted) {
    addFrame();
    step = pipeline.step();
    ASSERT_TRUE(step);
  }
  EXPECT_NE(step->reference.reference, nullptr) << "the draft goes to the tracker at once";
  step = pipeline.step();
  ASSERT_TRUE(step);
  EXPECT_EQ(step->kind, MapperStep::Kind::kRefinement);
  EXPECT_FALSE(step->output.keyframe) << "a piece of it";
  addFrame();
  step = pipeline.step();
  ASSERT_TRUE(step);
  EXPECT_EQ(step->kind, MapperStep::Kind::kFrame);
  step = pipeline.step();
  ASSERT_TRUE(step);
  EXPECT_EQ(step->kind, MapperStep::Kind::kRefinement);
}

TEST(MapperPipeline, AQuestionIsAnsweredAfterAllFramesThatWereAddedBefore) {
  MapperPipeline pipeline(config(), kQueueBytes);
  ASSERT_NE(begin(pipeline, 5).reference, nullptr);
  auto future = pipeline.ask([](const Mapper& mapper) { return mapper.finishedTrajectory(); });
  drain(pipeline);
  ASSERT_EQ(future.wait_for(std::chrono::seconds(0)), std::future_status::ready);
  EXPECT_FALSE(future.get().empty());
}

}  // namespace
}  // namespace mba_vo::test::mapper_pipeline_test
