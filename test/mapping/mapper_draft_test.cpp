#include <cstddef>
#include <optional>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

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

/// Of a camera that moves three times as fast. The second image is the sharpest, and so the reference.
std::vector<FrameConstPtr> everyThird() {
  std::vector<FrameConstPtr> images;
  for (std::size_t i = 0; i < frames().size(); i += 3) {
    auto image = std::make_shared<Frame>(*frames()[i]);
    image->mid_exposure_ns = frames()[0]->mid_exposure_ns + (image->mid_exposure_ns - frames()[0]->mid_exposure_ns) / 3;
    const ImageLevel& level = image->pyramid.level(0);
    cv::Mat1f soft;
    cv::GaussianBlur(level.intensity, soft, {}, 1.0);
    if (i != 3) image->pyramid = ImagePyramid(soft, level.camera, image->pyramid.levels());
    images.push_back(image);
  }
  return images;
}

/// What the tracker waits for comes first; where the camera is by then is a keyframe only if it has moved on.
TEST(MapperDraft, TheSecondKeyframeOfAMapComesAfterItsFirstReference) {
  const std::vector<FrameConstPtr> images = everyThird();
  for (const bool another_comes_first : {false, true}) {
    Mapper mapper(config());
    const Initialised initial = beginMap(mapper, images);
    ASSERT_NE(initial.output.reference, nullptr);
    EXPECT_EQ(initial.output.reference->id.keyframe_id, 0U);
    EXPECT_FALSE(initial.output.inserted);
    ASSERT_TRUE(mapper.needsRefinement());
    if (another_comes_first) {
      Vector6 turn = Vector6::Zero();
      for (int i = 0; i < 2; ++i, turn(4) += 0.4) {
        const FrameConstPtr& next = images.at(static_cast<std::size_t>(initial.frames_used + i));
        mapper.process(report(next, TrackingStatus::kTracking, initial.output.reference->id, SE3::exp(turn)));
      }
      ASSERT_EQ(mapper.currentReference()->id.keyframe_id, 1U);
      EXPECT_EQ(mapper.refine().initial_frames, 0);
      continue;
    }
    const MapperOutput second = mapper.refine();
    EXPECT_GE(second.initial_frames, 2);
    ASSERT_TRUE(second.inserted);
    EXPECT_EQ(second.reference->id.keyframe_id, 1U);
    EXPECT_LT(second.reference->mid_exposure_ns, initial.output.reference->hint->mid_exposure_ns);
    EXPECT_GT(second.reference->mid_exposure_ns, initial.output.reference->mid_exposure_ns);
    EXPECT_TRUE(mapper.needsRefinement());
    while (mapper.needsRefinement()) EXPECT_EQ(mapper.refine().initial_frames, 0);
  }
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
