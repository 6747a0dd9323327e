#include "mba_vo/mapping/mapper.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "mapping/follower.h"
#include "mapping/mapper_fixture.h"

namespace mba_vo::test::mapper_test {
namespace {

TEST(Mapper, SaysWhyThereIsNoMapYet) {
  Mapper mapper(config());
  const MapperOutput output = mapper.process(report(frames()[0], TrackingStatus::kInitializing));
  EXPECT_FALSE(output.message.empty());
  EXPECT_EQ(output.reference, nullptr);
  EXPECT_FALSE(output.keyframe);
  EXPECT_EQ(mapper.currentReference(), nullptr);
  EXPECT_TRUE(mapper.trajectory().empty());
  EXPECT_TRUE(mapper.points().empty());
}

TEST(Mapper, TheFirstReferenceTellsWhereItsFrameIs) {
  Mapper mapper(config());
  const Initialised initial = beginMap(mapper, frames());
  ASSERT_NE(initial.output.reference, nullptr);
  const Reference& reference = *initial.output.reference;
  EXPECT_EQ(mapper.currentReference(), initial.output.reference);
  EXPECT_NE(initial.output.message.find("initialised"), std::string::npos) << initial.output.message;
  EXPECT_EQ(reference.id.map_id, 1U);
  EXPECT_GT(reference.points.size(), 100U);
  EXPECT_EQ(reference.T_map_keyframe.count(reference.id.keyframe_id), 1U);
  EXPECT_FALSE(mapper.points().empty());
  ASSERT_TRUE(reference.hint);
  // The hint is about the newest frame that the initialiser could place: the tracker goes on from there.
  EXPECT_EQ(reference.cause, ReferenceCause::kMapBegins);
  EXPECT_GT(reference.hint->mid_exposure_ns, reference.mid_exposure_ns);
  EXPECT_GT(reference.hint->trajectory.velocity.norm(), 0.0);
  while (mapper.doDeferredWork()) continue;
  const std::size_t before = mapper.trajectory().size();
  EXPECT_LE(before, 2U) << "the keyframes: their points are not good enough yet to track other frames with";
  // The frames before it are in the trajectory, each once, by time.
  const auto trajectory = mapper.finishedTrajectory();
  EXPECT_GT(trajectory.size(), before);
  EXPECT_EQ(mapper.trajectory().size(), before) << "asking changes nothing";
  std::set<std::uint64_t> sequences;
  std::int64_t last = 0;
  for (const TrajectoryEntry& entry : trajectory) {
    EXPECT_TRUE(sequences.insert(entry.frame_sequence).second);
    EXPECT_GT(entry.mid_exposure_ns, last);
    EXPECT_EQ(entry.map_id, 1U);
    last = entry.mid_exposure_ns;
  }
  ASSERT_FALSE(trajectory.empty());
  EXPECT_EQ(trajectory.front().frame_sequence, frames()[0]->sequence);
  EXPECT_EQ(trajectory.back().mid_exposure_ns, reference.hint->mid_exposure_ns);
  EXPECT_EQ(trajectory.back().frame_sequence - trajectory.front().frame_sequence + 1, trajectory.size());
}

TEST(Mapper, MapsOfAMapperThatWasThereBeforeAreNotNumberedAgain) {
  Mapper mapper(config());
  ReferenceId of_before;
  of_before.map_id = 7;
  MapperOutput output;
  for (std::size_t i = 0; i < frames().size() && !output.reference; ++i) {
    output = mapper.process(report(frames()[i], TrackingStatus::kTracking, of_before));
  }
  ASSERT_NE(output.reference, nullptr);
  EXPECT_EQ(output.reference->id.map_id, 8U);
}

TEST(Mapper, AResultOfAnotherMapIsReportedAndNotUsed) {
  Mapper mapper(config());
  const Initialised initial = initialise(mapper);
  ASSERT_NE(initial.output.reference, nullptr);
  const std::size_t before = mapper.trajectory().size();
  const ReferenceConstPtr reference = mapper.currentReference();
  ReferenceId other = reference->id;
  other.map_id = 77;
  const MapperOutput output =
      mapper.process(report(frames()[static_cast<std::size_t>(initial.frames_used)], TrackingStatus::kTracking, other));
  EXPECT_NE(output.message.find("77"), std::string::npos) << output.message;
  EXPECT_EQ(output.reference, nullptr);
  EXPECT_FALSE(output.keyframe);
  EXPECT_EQ(mapper.trajectory().size(), before);
  EXPECT_EQ(mapper.currentReference(), reference);
}

TEST(Mapper, ATrackedFrameEntersTheTrajectoryAndALostOneDoesNot) {
  Mapper mapper(config());
  const Initialised initial = initialise(mapper);
  ASSERT_NE(initial.output.reference, nullptr);
  const Reference& reference = *initial.output.reference;
  const std::size_t before = mapper.trajectory().size();
  const auto next = static_cast<std::size_t>(initial.frames_used);
  mapper.process(report(frames()[next], TrackingStatus::kLost));
  EXPECT_EQ(mapper.trajectory().size(), before);
  const SE3 T_reference_mid = reference.hint->trajectory.T_reference_mid;
  mapper.process(report(frames()[next + 1], TrackingStatus::kDegraded, reference.id, T_reference_mid));
  const auto trajectory = mapper.trajectory();
  ASSERT_EQ(trajectory.size(), before + 1);
  EXPECT_EQ(trajectory.back().frame_sequence, next + 1);
  // A keyframe that was waiting for this frame may have been inserted, and the window refined.
  const SE3 T_map_keyframe = mapper.currentReference()->T_map_keyframe.at(reference.id.keyframe_id);
  const SE3 expected = T_map_keyframe * T_reference_mid;
  EXPECT_LT((trajectory.back().trajectory.T_reference_mid.inverse() * expected).log().norm(), 1e-7);  // kept as float
}

/// Feeds `count` frames that see the reference badly, turned away by 0.1 rad more each; true if a keyframe comes of
/// them.
bool turnsIntoKeyframe(Mapper& mapper, const Initialised& initial, bool provisional, int count) {
  bool keyframe = false;
  for (int i = 0; i < count; ++i) {
    Vector6 turn = Vector6::Zero();
    turn(4) = 0.1 * (i + 1);
    const FrameConstPtr& next = frames().at(static_cast<std::size_t>(initial.frames_used + i));
    const auto tracked = report(next, TrackingStatus::kTracking, initial.output.reference->id, SE3::exp(turn));
    auto copy = std::make_shared<TrackedFrame>(*tracked);
    copy->provisional = provisional;
    keyframe |= whole(mapper, copy).keyframe.has_value();
  }
  return keyframe;
}

/// Frames at the hint's place, whose images fit the newest keyframe with these errors [px]; the number of those after
/// which a keyframe was inserted, 0 if none was.
std::size_t framesUntilKeyframe(const std::vector<double>& pixel_errors) {
  Mapper mapper(config());
  const Initialised initial = initialise(mapper);
  const Reference& reference = *initial.output.reference;
  for (std::size_t i = 0; i < pixel_errors.size(); ++i) {
    const FrameConstPtr& next = frames().at(static_cast<std::size_t>(initial.frames_used) + i);
    const auto tracked =
        report(next, TrackingStatus::kTracking, reference.id, reference.hint->trajectory.T_reference_mid);
    auto copy = std::make_shared<TrackedFrame>(*tracked);
    copy->pixel_error = pixel_errors[i];
    if (mapper.process(copy).inserted) return i + 1;
  }
  return 0;
}

TEST(Mapper, AKeyframeThatExplainsTheImagesWorseAndWorseIsFollowedByTheNext) {
  EXPECT_EQ(framesUntilKeyframe({0.2, 0.2, 0.35, 0.39, 0.39, 0.41, 0.2}), 7U) << "with the frame after";
  EXPECT_EQ(framesUntilKeyframe({0.4, 0.4, 0.41, 0.41}), 0U) << "by its own first error";
}

TEST(Mapper, AProvisionalFrameIsOnlyForTheTrajectory) {
  Mapper mapper(config());
  const Initialised initial = initialise(mapper);
  ASSERT_NE(initial.output.reference, nullptr);
  const std::size_t before = mapper.trajectory().size();
  EXPECT_FALSE(turnsIntoKeyframe(mapper, initial, true, 3));
  EXPECT_EQ(mapper.trajectory().size(), before + 3);
  // Tracked again they come once more, for the map too.
  EXPECT_TRUE(turnsIntoKeyframe(mapper, initial, false, 3));
  EXPECT_EQ(mapper.trajectory().size(), before + 3);
}

TEST(Mapper, AFrameThatComesAgainGetsItsNewPoseOnly) {
  Mapper mapper(config());
  const Initialised initial = initialise(mapper);
  ASSERT_NE(initial.output.reference, nullptr);
  const FrameConstPtr& first = frames().at(static_cast<std::size_t>(initial.frames_used));
  const FrameConstPtr& second = frames().at(static_cast<std::size_t>(initial.frames_used + 1));
  const ReferenceId id = initial.output.reference->id;
  mapper.process(report(first, TrackingStatus::kTracking, id));
  mapper.process(report(second, TrackingStatus::kTracking, id));
  Vector6 step = Vector6::Zero();
  step(0) = 0.01;
  mapper.process(report(first, TrackingStatus::kTracking, id, SE3::exp(step)));
  const SE3 T_reference_map = initial.output.reference->T_map_reference.inverse();
  const auto pose = [&](const FrameConstPtr& frame) {
    for (const TrajectoryEntry& entry : mapper.trajectory()) {
      if (entry.frame_sequence == frame->sequence) return T_reference_map * entry.trajectory.T_reference_mid;
    }
    ADD_FAILURE() << "no pose";
    return SE3();
  };
  EXPECT_NEAR(pose(first).translation().x(), 0.01, 1e-9);
  EXPECT_NEAR(pose(second).translation().norm(), 0.0, 1e-9);
  // In vain: what is there stays.
  mapper.process(report(first, TrackingStatus::kLost));
  EXPECT_NEAR(pose(first).translation().x(), 0.01, 1e-9);
}

TEST(Mapper, ARestartedTrackerIsGivenTheCurrentReferenceAgain) {
  Mapper mapper(config());
  const Initialised initial = initialise(mapper);
  ASSERT_NE(initial.output.reference, nullptr);
  ReferenceConstPtr again;
  for (int i = 0; i < 40 && !again; ++i) {
    again = mapper.process(report(shifted(frames()[0], 5.0 + 0.04 * i), TrackingStatus::kInitializing)).reference;
  }
  ASSERT_NE(again, nullptr);
  EXPECT_EQ(again->id.map_id, initial.output.reference->id.map_id);
  ASSERT_TRUE(again->hint);
  const TrackingHint& first = *initial.output.reference->hint;  // nothing was tracked since
  EXPECT_EQ(again->hint->mid_exposure_ns, first.mid_exposure_ns);
  const SE3 T_map_hint = again->T_map_reference * again->hint->trajectory.T_reference_mid;
  const SE3 T_map_first = initial.output.reference->T_map_reference * first.trajectory.T_reference_mid;
  EXPECT_LT((T_map_hint.inverse() * T_map_first).log().norm(), 1e-9);
}

TEST(Mapper, ResetForgetsTheMapButNotTheTrajectory) {
  Mapper mapper(config());
  ASSERT_NE(initialise(mapper).output.reference, nullptr);
  const std::size_t before = mapper.trajectory().size();
  mapper.reset();
  EXPECT_EQ(mapper.currentReference(), nullptr);
  EXPECT_TRUE(mapper.points().empty());
  EXPECT_GE(mapper.trajectory().size(), before) << "and all that had been put off";
  const Initialised again = initialise(mapper, 20.0);
  ASSERT_NE(again.output.reference, nullptr);
  EXPECT_EQ(again.output.reference->id.map_id, 2U);
}

TEST(Mapper, ASavedMapHasKeyframesAsTheyWereWhenTheyLeftTheWindowOrAreNow) {
  MapperConfig small = config();
  small.window.max_keyframes = small.window.min_keyframes = 3;
  Mapper mapper(small);
  Follower follower(mapper);
  for (int i = 0; i < 5; ++i) follower.toNextKeyframe();
  const KeyframeId newest = mapper.currentReference()->id.keyframe_id;
  int departed = 0;
  const SavedMap saved = mapper.savedMap().value();
  for (const ArchivedKeyframe& keyframe : saved.keyframes) {
    const KeyframeId id = keyframe.reference.id.keyframe_id;
    const KeyframeId known = keyframe.reference.T_map_keyframe.rbegin()->first;  // the newest at that time
    if (mapper.currentReference()->T_map_keyframe.count(id) > 0) {
      EXPECT_EQ(known, newest) << id;
    } else {
      EXPECT_GT(known, id);
      ++departed;
    }
  }
  EXPECT_GE(departed, 2);
}

}  // namespace
}  // namespace mba_vo::test::mapper_test
