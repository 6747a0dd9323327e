#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "mapping/follower.h"
#include "mapping/mapper_fixture.h"
#include "mba_vo/mapping/mapper.h"

namespace mba_vo::test::mapper_loss_test {
namespace {

/// Reports frames as lost, or as waiting for a map once the tracker has given up, every 40 ms for so long.
std::string loseFor(Mapper& mapper, double seconds, double tracker_gives_up_after, bool blind = false) {
  std::string messages;
  static const FrameConstPtr unknown = elsewhere(frames().back());
  for (double t = 0.0; t <= seconds; t += 0.04) {
    const FrameConstPtr frame = shifted(unknown, 10.0 + t);
    const bool given_up = t >= tracker_gives_up_after;
    const auto status = given_up ? TrackingStatus::kInitializing : TrackingStatus::kLost;
    auto tracked = std::make_shared<TrackedFrame>(*report(frame, status));
    tracked->blind = blind;
    messages += whole(mapper, tracked).message;
  }
  return messages;
}

TEST(Mapper, AMapThatContradictsItsImagesIsGivenUpAndItsPosesForgotten) {
  MapperConfig demanding = config();
  demanding.health.wrong_error = 0.1;  // [px] no map is as good as that
  Mapper mapper(demanding);
  const Initialised initial = initialise(mapper);
  ASSERT_NE(initial.output.reference, nullptr);
  const MapId map = initial.output.reference->id.map_id;
  EXPECT_FALSE(mapper.trajectory().empty());
  MapperOutput output;
  for (int i = 0; i < 3 && !output.keyframe; ++i) {
    Vector6 turn = Vector6::Zero();
    turn(4) = 0.1 * (i + 1);
    const FrameConstPtr& next = frames().at(static_cast<std::size_t>(initial.frames_used + i));
    output = whole(mapper, report(next, TrackingStatus::kTracking, initial.output.reference->id, SE3::exp(turn)));
  }
  ASSERT_TRUE(output.keyframe);
  EXPECT_NE(output.message.find("map 1 was given up"), std::string::npos) << output.message;
  for (const TrajectoryEntry& entry : mapper.trajectory()) EXPECT_NE(entry.map_id, map);
  // The tracker is told, by the next map if the frames of the beginning make one.
  ASSERT_NE(output.reference, nullptr);
  const bool closed = output.reference->cause == ReferenceCause::kMapClosed;
  EXPECT_EQ(closed, !output.reference->closed_because.empty());
  EXPECT_EQ(closed, output.reference->id.map_id == map);
}

TEST(Mapper, AMapThatItsFirstFramesContradictIsGivenUpAndItsPosesForgotten) {
  Mapper mapper(config());
  const Initialised initial = initialise(mapper);
  ASSERT_NE(initial.output.reference, nullptr);
  const ReferenceId first = initial.output.reference->id;
  MapperOutput output;
  int used = 0;
  while (output.message.find("was given up") == std::string::npos && used < 30) {
    const FrameConstPtr& next = frames().at(static_cast<std::size_t>(initial.frames_used + used++));
    auto badly = std::make_shared<TrackedFrame>(*report(next, TrackingStatus::kDegraded, first));
    badly->pixel_error = 1.5;
    badly->provisional = true;  // no keyframe comes of it, by which the map could be judged
    output = mapper.process(badly);
  }
  EXPECT_EQ(used, 16);
  EXPECT_NE(output.message.find("its first frames contradict it"), std::string::npos) << output.message;
  ASSERT_NE(output.reference, nullptr);
  EXPECT_TRUE(output.reference->cause == ReferenceCause::kMapClosed || output.reference->id.map_id != first.map_id);
  for (const TrajectoryEntry& entry : mapper.trajectory()) EXPECT_NE(entry.map_id, first.map_id);
}

TEST(Mapper, BeingLostForLongBeginsANewMapWithANewId) {
  Mapper mapper(config());
  ASSERT_NE(initialise(mapper).output.reference, nullptr);
  const std::size_t before = mapper.trajectory().size();
  loseFor(mapper, 0.8, 1e9);
  EXPECT_NE(mapper.currentReference(), nullptr) << "not lost for long yet";
  const std::string messages = loseFor(mapper, 1.3, 1e9);
  EXPECT_NE(messages.find("lost"), std::string::npos) << messages;
  EXPECT_EQ(mapper.currentReference(), nullptr);
  const Initialised again = initialise(mapper, 20.0);
  ASSERT_NE(again.output.reference, nullptr);
  EXPECT_EQ(again.output.reference->id.map_id, 2U);
  const auto trajectory = mapper.trajectory();
  EXPECT_GT(trajectory.size(), before);
  EXPECT_EQ(trajectory.front().map_id, 1U);
  EXPECT_EQ(trajectory.back().map_id, 2U);
}

TEST(Mapper, AMapMayEndBeforeItsSecondKeyframe) {
  for (const bool lost : {false, true}) {
    Mapper mapper(config());
    ASSERT_NE(beginMap(mapper, frames()).output.reference, nullptr);
    ASSERT_TRUE(mapper.needsRefinement());
    if (lost) mapper.process(report(shifted(elsewhere(frames()[0]), 10.0), TrackingStatus::kLost));
    if (!lost) mapper.reset();
    EXPECT_FALSE(mapper.needsRefinement());
    EXPECT_EQ(mapper.currentReference() != nullptr, lost);
  }
}

// On fast turns the last frame that was tracked has seen what comes next; to wait for the frame after it would lose it.
TEST(Mapper, AFrameThatIsToBecomeAKeyframeDoesSoAtOnceWhenTheCameraIsLost) {
  const auto stepsUntilKeyframe = [](Mapper& mapper, int most, std::uint64_t& keyframe_frame) {
    Follower follower(mapper);
    for (int i = 1; i <= most; ++i) {
      const MapperOutput output = follower.step();
      if (!output.keyframe) continue;
      keyframe_frame = output.keyframe->frame_sequence;
      return i;
    }
    return most;
  };
  Mapper undisturbed(config());
  std::uint64_t expected = 0, none = 0;
  const int steps = stepsUntilKeyframe(undisturbed, 30, expected);
  ASSERT_LT(steps, 30);
  Mapper mapper(config());
  EXPECT_EQ(stepsUntilKeyframe(mapper, steps - 1, none), steps - 1);  // the frame waits
  const FrameConstPtr next = shifted(elsewhere(frames().back()), 10.0);
  const MapperOutput output = whole(mapper, report(next, TrackingStatus::kLost));
  ASSERT_TRUE(output.keyframe);
  EXPECT_EQ(output.keyframe->frame_sequence, expected);
  ASSERT_NE(output.reference, nullptr);
  EXPECT_EQ(output.reference->id.keyframe_id, output.keyframe->keyframe_id);
  EXPECT_FALSE(whole(mapper, report(shifted(next, 0.04), TrackingStatus::kLost)).keyframe) << "once is enough";
}

TEST(Mapper, GivesUpItsMapTogetherWithTheTracker) {
  // The tracker, lost for as long, reports INITIALIZING from then on: the mapper must not wait for one more LOST.
  Mapper mapper(config());
  ASSERT_NE(initialise(mapper).output.reference, nullptr);
  loseFor(mapper, 1.3, config().restart_after_lost);
  EXPECT_EQ(mapper.currentReference(), nullptr);
  EXPECT_EQ(mapper.phase(), MappingPhase::kInitializing);
}

TEST(Mapper, ACoveredLensCostsNoMap) {
  Mapper mapper(config());
  ASSERT_NE(initialise(mapper).output.reference, nullptr);
  loseFor(mapper, 3.0, 1e9, true);
  EXPECT_NE(mapper.currentReference(), nullptr);
}

TEST(Mapper, FindsALostCameraByItsKeyframes) {
  Mapper mapper(config());
  const Initialised initial = initialise(mapper);
  ASSERT_NE(initial.output.reference, nullptr);
  const std::uint64_t first = initial.output.reference->hint->frame_sequence - frames()[0]->sequence;
  const auto trajectory = mapper.finishedTrajectory();
  ReferenceConstPtr found;
  for (std::size_t i = 0; i < 10 && !found; ++i) {
    const FrameConstPtr frame =
        shifted(frames().at(static_cast<std::size_t>(first) - i - 1), 10.0 + 0.08 * static_cast<double>(i));
    found = mapper.process(report(frame, TrackingStatus::kLost)).reference;
    EXPECT_EQ(mapper.phase(), found ? MappingPhase::kMapping : MappingPhase::kLost);
    if (!found) continue;
    ASSERT_TRUE(found->hint);
    EXPECT_EQ(found->hint->frame_sequence, frame->sequence);
    EXPECT_EQ(found->id.map_id, initial.output.reference->id.map_id);
    const SE3 T_map_frame = found->T_map_reference * found->hint->trajectory.T_reference_mid;
    for (const TrajectoryEntry& entry : trajectory) {  // where it was tracked backwards
      if (entry.frame_sequence + 1000 != frame->sequence) continue;
      EXPECT_LT((T_map_frame.inverse() * entry.trajectory.T_reference_mid).log().norm(), 0.01);
    }
  }
  EXPECT_NE(found, nullptr);
}

// What was found for it would come when the tracker is elsewhere, and take it there.
TEST(Mapper, DoesNotLookForLostFramesOfThePast) {
  Mapper mapper(config());
  Follower follower(mapper);
  const ReferenceId older = mapper.currentReference()->id;
  follower.toNextKeyframe();
  const ReferenceId newest = mapper.currentReference()->id;
  ASSERT_GT(newest.keyframe_id, older.keyframe_id);
  const auto lost = [](double t, const ReferenceId& tried) {
    auto frame = std::make_shared<TrackedFrame>(*report(shifted(frames()[0], t), TrackingStatus::kLost));
    frame->reference = tried;
    return frame;
  };
  EXPECT_FALSE(mapper.process(lost(10.0, newest)).searched) << "not lost for long yet";
  EXPECT_FALSE(mapper.process(lost(10.2, newest), false).searched) << "newer frames wait";
  EXPECT_TRUE(mapper.process(lost(10.4, newest)).searched);
  EXPECT_FALSE(mapper.process(lost(10.6, older)).searched) << "a newer keyframe is on its way";
}

TEST(Mapper, ATrackedFrameEndsBeingLost) {
  Mapper mapper(config());
  const Initialised initial = initialise(mapper);
  ASSERT_NE(initial.output.reference, nullptr);
  const Reference& reference = *initial.output.reference;
  for (int i = 0; i < 5; ++i) {
    const double t = 10.0 + 0.7 * i;
    mapper.process(report(shifted(frames()[0], t), TrackingStatus::kLost));
    EXPECT_EQ(mapper.phase(), MappingPhase::kLost);
    mapper.process(report(shifted(frames()[1], t), TrackingStatus::kTracking, reference.id,
                          reference.hint->trajectory.T_reference_mid));
    EXPECT_EQ(mapper.phase(), MappingPhase::kMapping);
  }
  EXPECT_NE(mapper.currentReference(), nullptr);
}

}  // namespace
}  // namespace mba_vo::test::mapper_loss_test
