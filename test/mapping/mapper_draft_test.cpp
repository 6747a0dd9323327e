#include <cstddef>
#include <optional>

#include <gtest/gtest.h>

#include "mapping/follower.h"

namespace mba_vo::test::mapper_draft_test {
namespace {

constexpr double kClose = 5e-3;  // [m, rad]

double distance(const SE3& a, const SE3& b) { return (a.inverse() * b).log().norm(); }

TEST(MapperDraft, AKeyframeIsOfUseBeforeTheWindowIsOptimised) {
  Mapper mapper(config());
  Follower follower(mapper);
  for (std::size_t i = 1; i <= 3; ++i) {
    const MapperOutput output = follower.toNextKeyframe();
    ASSERT_NE(follower.draft(), nullptr);
    const Reference& draft = *follower.draft();
    const Reference& refined = *output.reference;
    EXPECT_EQ(draft.id.keyframe_id, refined.id.keyframe_id);
    EXPECT_LT(draft.id.revision, refined.id.revision);
    EXPECT_GT(draft.points.size(), refined.points.size() / 2);
    EXPECT_LT(distance(draft.T_map_reference, refined.T_map_reference), kClose);
    EXPECT_GT(distance(draft.T_map_reference, refined.T_map_reference), 0.0) << "it has not been optimised yet";
    const TrackedFrame by_draft = follower.track(draft);
    EXPECT_EQ(by_draft.status, TrackingStatus::kTracking) << by_draft.reason;
    const SE3 by_refined = follower.track(refined).trajectory.T_reference_mid;
    EXPECT_LT(distance(by_draft.trajectory.T_reference_mid, by_refined), kClose);
    ASSERT_TRUE(output.keyframe);
    EXPECT_EQ(output.keyframe->wanted_points, config().window.max_points);
  }
}

/// Frames that come faster than keyframes are refined, each turned away by 0.1 rad more.
TEST(MapperDraft, AKeyframeWhoseViewIsBeingLeftDoesNotWaitForTheOneBefore) {
  Mapper mapper(config());
  const Initialised initial = initialise(mapper);
  ASSERT_NE(initial.output.reference, nullptr);
  EXPECT_FALSE(mapper.needsRefinement());
  int inserted = 0;
  int refined = 0;
  for (int i = 0; i < 12; ++i) {
    Vector6 turn = Vector6::Zero();
    turn(4) = 0.1 * (i + 1);
    const FrameConstPtr& next = frames().at(static_cast<std::size_t>(initial.frames_used + i));
    const MapperOutput output =
        mapper.process(report(next, TrackingStatus::kTracking, initial.output.reference->id, SE3::exp(turn)));
    inserted += output.inserted ? 1 : 0;
    refined += output.keyframe ? 1 : 0;
    if (output.keyframe) {
      EXPECT_EQ(output.keyframe->residuals, 0) << "an optimisation was begun for nothing";
    }
    EXPECT_EQ(output.inserted, output.reference != nullptr) << "a draft";
  }
  EXPECT_GE(inserted, 2);
  EXPECT_EQ(refined, inserted - 1) << "those before had to do with what there was";
  int pieces = 0;
  std::optional<KeyframeReport> last;
  for (; mapper.needsRefinement(); ++pieces) last = mapper.refine().keyframe;
  EXPECT_GE(pieces, 3);
  ASSERT_TRUE(last);
  EXPECT_GT(last->residuals, 0);
  EXPECT_LT(last->wanted_points, 0.8 * config().window.max_points) << "those before were not optimised at all";
}

/// It waits no longer than the view stays, and moves as the frames on both sides say, once there are two.
TEST(MapperDraft, AKeyframeThatDidNotWaitGetsItsMotionWhenTheNextFrameHasCome) {
  Mapper mapper(config());
  const Initialised initial = initialise(mapper);
  ASSERT_NE(initial.output.reference, nullptr);
  const auto frame = [&](int i) { return frames().at(static_cast<std::size_t>(initial.frames_used + i)); };
  const auto turned = [&](int i, double angle) {
    Vector6 turn = Vector6::Zero();
    turn(4) = angle;
    return mapper.process(report(frame(i), TrackingStatus::kTracking, initial.output.reference->id, SE3::exp(turn)));
  };
  const double interval = frame(1)->midExposureSeconds() - frame(0)->midExposureSeconds();
  EXPECT_FALSE(turned(0, 0.0).inserted);
  EXPECT_FALSE(turned(1, 0.02).inserted);
  const MapperOutput draft = turned(2, 0.42);
  ASSERT_TRUE(draft.inserted) << "the view is left all at once";
  turned(3, 0.52);
  ReferenceConstPtr refined;
  while (mapper.needsRefinement()) refined = mapper.refine().reference;
  ASSERT_NE(refined, nullptr);
  ASSERT_EQ(refined->id.keyframe_id, draft.reference->id.keyframe_id);
  EXPECT_NEAR(draft.reference->motion.velocity(4), (0.40 + 0.5 * (0.40 - 0.02)) / interval, 0.1);
  EXPECT_NEAR(refined->motion.velocity(4), (0.52 - 0.02) / (2.0 * interval), 0.1);
}

}  // namespace
}  // namespace mba_vo::test::mapper_draft_test
