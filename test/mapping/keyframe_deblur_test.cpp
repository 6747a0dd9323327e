#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "deblur/fake_deblurrers.h"
#include "io/temporary_folder.h"
#include "mapping/follower.h"
#include "mapping/mapper_fixture.h"

namespace mba_vo::test::keyframe_deblur_test {
namespace {

constexpr int kImages = 60;
constexpr double kExposure = 0.03;  // [s]

/// Blurred images and what they would be without blur.
struct Twins {
  std::vector<FrameConstPtr> blurred;
  std::vector<FrameConstPtr> sharp;
};

const Twins& twins() {
  static const Twins kTwins = [] {
    SimulationConfig simulation = sequenceConfig(kExposure);
    simulation.trajectory_seed = 3;
    const RenderedSequence rendered = renderFrames(simulation, 0, kImages);
    return Twins{toFrames(rendered, false, kExposure), toFrames(rendered, true, kExposure)};
  }();
  return kTwins;
}

/// Knows the truth.
DeblurResult truth(const DeblurInput& input) {
  DeblurResult result;
  const std::uint64_t index = input.sequence - twins().sharp.front()->sequence;
  result.image = std::make_shared<const ImagePyramid>(twins().sharp.at(index)->pyramid);
  result.sharpened = true;
  result.residual = 1.0F;
  return result;
}

/// With as many keyframes deblurred as the CPU can, and all of them used.
MapperConfig eager(bool deterministic) {
  MapperConfig c = config();
  c.deblur.check = false;
  c.deterministic = deterministic;
  c.deblur_queue.per_second = 1000.0;
  return c;
}

TEST(KeyframeDeblur, TheSharpImageTakesThePlaceOfTheBlurredOne) {
  const auto deblurrer = std::make_shared<FakeDeblurrer>(truth);
  Mapper mapper(eager(true), deblurrer);
  Follower follower(mapper, twins().blurred);
  const Reference first = follower.reference();
  EXPECT_FALSE(first.image_xi.isZero(0.0)) << "the map begins without waiting";
  EXPECT_EQ(mapper.deblurCounts().waiting, first.id.keyframe_id + 1) << "one or two keyframes: whether it goes along";

  EXPECT_FALSE(follower.step().sharp_keyframe) << "begins with the first frame, is taken with the next";
  MapperOutput output = follower.step();
  while (!(output.sharp_keyframe && output.sharp_keyframe->keyframe_id == first.id.keyframe_id)) {
    ASSERT_FALSE(follower.atEnd());
    EXPECT_FALSE(output.reference) << "the tracker uses another";
    output = follower.step();
  }
  EXPECT_EQ(output.sharp_keyframe->keyframe_id, first.id.keyframe_id);
  EXPECT_TRUE(output.sharp_keyframe->in_map);
  EXPECT_EQ(output.sharp_keyframe->frame->mid_exposure_ns, first.mid_exposure_ns);
  const DeblurInput given = deblurrer->inputs().at(first.id.keyframe_id);
  EXPECT_EQ(given.sequence, output.sharp_keyframe->frame->sequence);
  EXPECT_EQ(given.image, first.pyramid);
  EXPECT_EQ(given.motion.exposure, kExposure);
  EXPECT_EQ(given.motion.velocity, first.motion.velocity);
  EXPECT_EQ(given.depths.size(), first.points.size());

  ASSERT_TRUE(output.reference) << "the tracker is given it at once";
  EXPECT_EQ(output.reference->id.keyframe_id, first.id.keyframe_id);
  EXPECT_GT(output.reference->id.revision, first.id.revision);
  EXPECT_EQ(output.reference->pyramid, output.sharp_keyframe->image);
  EXPECT_TRUE(output.reference->image_xi.isZero(0.0));
  EXPECT_EQ(mapper.currentReference(), output.reference);
  for (int i = 0; i < 2; ++i) follower.toNextKeyframe();
  EXPECT_GE(mapper.deblurCounts().sharpened, 2U);
  EXPECT_EQ(mapper.deblurCounts().in_map, mapper.deblurCounts().sharpened);
}

TEST(KeyframeDeblur, AnImageThatExplainsTheOtherKeyframesWorseIsHandedOutAlone) {
  MapperConfig checked = eager(true);
  checked.deblur.check = true;
  const auto flipped = [](const DeblurInput& input) {
    DeblurResult result;
    cv::Mat1f image;
    cv::flip(input.image->level(0).intensity, image, 0);
    result.image = std::make_shared<const ImagePyramid>(image, input.image->level(0).camera, input.image->levels());
    result.sharpened = true;
    return result;
  };
  Mapper mapper(checked, std::make_shared<FakeDeblurrer>(flipped));
  Follower follower(mapper, twins().blurred);
  std::uint64_t handed_out = 0;
  while (!follower.atEnd()) {
    const MapperOutput output = follower.step();
    if (output.reference) {
      EXPECT_FALSE(output.reference->image_xi.isZero(0.0));
    }
    if (!output.sharp_keyframe) continue;
    ++handed_out;
    EXPECT_FALSE(output.sharp_keyframe->in_map);
    EXPECT_NE(output.sharp_keyframe->image, mapper.currentReference()->pyramid);
  }
  EXPECT_GT(handed_out, 1U);
  EXPECT_EQ(mapper.deblurCounts().sharpened, handed_out);
  EXPECT_EQ(mapper.deblurCounts().in_map, 0U);
}

/// Where the mapper takes blurred images for sharp ones, a true sharp one explains the others better.
TEST(KeyframeDeblur, AnImageThatExplainsTheOtherKeyframesBetterGetsIntoTheMap) {
  MapperConfig checked = eager(true);
  checked.deblur.check = true;
  checked.commute_blur = false;
  Mapper mapper(checked, std::make_shared<FakeDeblurrer>(truth));
  Follower follower(mapper, twins().blurred);
  while (!follower.atEnd()) follower.step();
  EXPECT_GT(mapper.deblurCounts().in_map, 0U);
}

/// What is handed out while somebody looks, where no method is named.
TEST(KeyframeDeblur, WhileSomebodyLooksKeyframesAreSharpenedAndTheMapStaysAsItIs) {
  MapperConfig none = eager(true);
  none.deblur.trajectory.min_blur_px = 0.2;
  none.deblur.trajectory.max_residual = none.deblur.trajectory.max_disagreement = 10.0;
  none.deblur.trajectory.steps = none.deblur.trajectory.iterations = 1;
  Mapper unwatched(none);
  Mapper watched(none);
  Follower follower(unwatched, twins().blurred);
  Follower looker(watched, twins().blurred);
  watched.watchSharpKeyframes(true);
  std::uint64_t sharpened = 0;
  while (sharpened < 2 && !looker.atEnd()) {
    const MapperOutput alone = follower.step();
    const MapperOutput output = looker.step();
    EXPECT_FALSE(alone.sharp_keyframe);
    ASSERT_EQ(static_cast<bool>(alone.reference), static_cast<bool>(output.reference));
    if (output.reference) {
      EXPECT_EQ(output.reference->T_map_reference.log(), alone.reference->T_map_reference.log());
      EXPECT_FALSE(output.reference->image_xi.isZero(0.0)) << "the map goes on with the original";
    }
    if (!output.sharp_keyframe) continue;
    ++sharpened;
    EXPECT_FALSE(output.sharp_keyframe->in_map);
    EXPECT_NE(output.sharp_keyframe->image->level(0).intensity.data,
              output.sharp_keyframe->frame->pyramid.level(0).intensity.data);
  }
  EXPECT_EQ(sharpened, 2U);
  EXPECT_EQ(unwatched.deblurCounts().offered, 0U) << "nobody looks: it costs nothing";

  watched.watchSharpKeyframes(false);
  const DeblurCounts before = watched.deblurCounts();
  EXPECT_EQ(before.waiting, 0U);
  while (!looker.atEnd()) EXPECT_FALSE(looker.step().sharp_keyframe);
  EXPECT_EQ(watched.deblurCounts().offered, before.offered) << "nobody looks any more";
}

TEST(KeyframeDeblur, TheMapGoesOnWhileTheCpuIsTooSlow) {
  const auto slow = std::make_shared<SlowDeblurrer>(truth);
  MapperConfig busy = eager(false);
  busy.keyframe.flow_px = busy.keyframe.parallax_px = 5.0;  // many keyframes
  Mapper mapper(busy, slow);
  Follower follower(mapper, twins().blurred);
  std::uint64_t keyframes = follower.reference().id.keyframe_id + 1;
  while (!follower.atEnd()) {
    const MapperOutput output = follower.step();
    EXPECT_FALSE(output.sharp_keyframe);
    if (!output.keyframe) continue;
    ++keyframes;
    ASSERT_TRUE(output.reference);
    EXPECT_EQ(output.reference->id.keyframe_id, output.keyframe->keyframe_id);
    EXPECT_FALSE(output.reference->image_xi.isZero(0.0)) << "as without deblurring";
  }
  const DeblurCounts counts = mapper.deblurCounts();
  EXPECT_GT(keyframes, 4U);
  EXPECT_EQ(counts.offered, keyframes);
  EXPECT_EQ(counts.sharpened, 0U);
  EXPECT_LE(counts.waiting, 3U) << "two, and that which is being worked on";
  EXPECT_GT(counts.too_slow + counts.passed_over, 0U)
      << "which of both is a matter of the order of their blur (deblur_queue_test)";
  EXPECT_EQ(counts.waiting + counts.too_slow + counts.passed_over, counts.offered);
  slow->letGo();  // the mapper's end waits for it
}

TEST(KeyframeDeblur, AResetWaitsForNothingAndNoResultGetsIntoTheNextMap) {
  const auto slow = std::make_shared<SlowDeblurrer>(truth);
  Mapper mapper(eager(false), slow);
  {
    Follower follower(mapper, twins().blurred);
    follower.step();
  }
  const std::uint64_t keyframes = mapper.currentReference()->id.keyframe_id + 1;
  mapper.reset();
  EXPECT_EQ(mapper.deblurCounts().forgotten, keyframes);
  EXPECT_EQ(mapper.deblurCounts().waiting, 0U);
  const std::vector<FrameConstPtr> later(twins().blurred.begin() + 5, twins().blurred.end());
  Follower follower(mapper, later);
  slow->letGo(2 * kImages);
  while (!follower.atEnd()) {
    const std::optional<SharpKeyframe> sharp = follower.step().sharp_keyframe;
    if (sharp) {
      EXPECT_EQ(slow->sequenceOf(sharp->image), sharp->frame->sequence);
    }
  }
}

TEST(KeyframeDeblur, AMapThatIsLostTakesItsTasksAlong) {
  const auto slow = std::make_shared<SlowDeblurrer>(truth);
  Mapper mapper(eager(false), slow);
  const Initialised initial = initialise(mapper, twins().blurred);
  ASSERT_TRUE(initial.output.reference);
  for (double t = 0.0; mapper.currentReference() && t < 3.0; t += 0.04) {
    auto lost = std::make_shared<TrackedFrame>();
    lost->frame = shifted(frames().front(), 10.0 + t);
    lost->status = TrackingStatus::kLost;
    mapper.process(lost);
  }
  EXPECT_FALSE(mapper.currentReference());
  EXPECT_EQ(mapper.deblurCounts().forgotten, mapper.deblurCounts().offered);
}

TEST(KeyframeDeblur, AnImageWithoutExposureTimeIsSharp) {
  const auto deblurrer = std::make_shared<FakeDeblurrer>(copyOf);
  Mapper mapper(eager(true), deblurrer);
  Follower follower(mapper);
  follower.toNextKeyframe();
  EXPECT_EQ(mapper.deblurCounts().offered, 0U);
}

/// Here by images in a folder, 9 grey levels brighter, and with an exposure that nobody knows.
TEST(KeyframeDeblur, TheConfigurationNamesTheDeblurrer) {
  const TemporaryFolder folder;
  std::vector<FrameConstPtr> images;
  for (const FrameConstPtr& frame : frames()) {
    char name[32];
    std::snprintf(name, sizeof(name), "%06d.png", static_cast<int>(frame->sequence));
    cv::imwrite(folder.file(name), frame->pyramid.level(0).intensity + 9.0F);
    auto copy = std::make_shared<Frame>(*frame);
    copy->exposure.reset();
    images.push_back(copy);
  }
  MapperConfig c = eager(true);
  c.deblur.method = "folder";
  c.deblur.folder.images = folder.file("");
  Mapper mapper(c);
  Follower follower(mapper, images);
  follower.step();
  const std::optional<SharpKeyframe> sharp = follower.step().sharp_keyframe;
  ASSERT_TRUE(sharp);
  const float original = sharp->frame->pyramid.level(0).intensity(100, 120);
  ASSERT_LT(original, 240.0F);
  EXPECT_NEAR(sharp->image->level(0).intensity(100, 120), original + 9.0F, 0.51F);
}

}  // namespace
}  // namespace mba_vo::test::keyframe_deblur_test
