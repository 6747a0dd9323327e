#include "mba_vo/relocalization/relocalizer.h"

#include <gtest/gtest.h>

#include "support/rendered_room.h"

namespace mba_vo::relocalizer_test {
namespace {

constexpr double kExposure = 0.01;  // [s]
constexpr double kInterval = 0.04;  // [s]

SE3 moved(double right, double forward, double yaw) {
  Vector6 motion = Vector6::Zero();
  motion << right, 0.0, forward, 0.0, yaw, 0.0;
  return SE3::exp(motion);
}

SE3 placeOf(KeyframeId keyframe) { return test::roomSimulator().pose(1.0) * moved(0.0, 0.0, 1.1 * keyframe); }

SimulatedFrame renderAt(const SE3& T_world_camera, const Vector6& velocity, double t) {
  return test::roomSimulator().renderExposure(test::constantVelocity(T_world_camera, velocity), 0.0, kExposure,
                                              static_cast<std::uint64_t>(std::lround(t / kInterval)));
}

FrameConstPtr frameOf(const SimulatedFrame& rendered, double t) {
  return test::makeFrame(test::toFloat(rendered.blurred), std::llround(1e9 * t), kExposure,
                         static_cast<std::uint64_t>(std::lround(t / kInterval)));
}

/// Knows four views, each of them turned by 1.1 rad from the last.
Relocalizer makeRelocalizer(const RelocalizerConfig& config) {
  Relocalizer relocalizer(config, TrackerConfig());
  for (KeyframeId id = 0; id < 4; ++id) {
    const SimulatedFrame rendered = renderAt(placeOf(id), Vector6::Zero(), 0.0);
    auto reference = test::makeReference(rendered, test::toFloat(rendered.sharp));
    reference->id = {1, id, 0};
    reference->T_map_reference = placeOf(id);
    relocalizer.archive().add(*reference, *frameOf(rendered, 0.0));
  }
  return relocalizer;
}

/// Frames of a moving camera from `T_world_first` on, until it is found.
struct Search {
  std::optional<Relocalizer::Found> found;
  int frames = 0;
  SE3 T_world_last;
};
Search search(Relocalizer& relocalizer, const SE3& T_world_first, int most) {
  Vector6 velocity;
  velocity << 0.2, 0.05, -0.1, 0.1, 0.4, 0.1;
  Search result;
  for (; !result.found && result.frames < most; ++result.frames) {
    const double t = 10.0 + kInterval * result.frames;
    result.T_world_last = T_world_first * SE3::exp(kInterval * result.frames * velocity);
    result.found = relocalizer.find(frameOf(renderAt(result.T_world_last, velocity, t), t), 0.3);
  }
  return result;
}

TEST(Relocalizer, FindsTheCameraByTheKeyframeThatSawThePlace) {
  for (const KeyframeId id : {0U, 2U}) {
    Relocalizer relocalizer = makeRelocalizer({});
    const Search result = search(relocalizer, placeOf(id) * moved(0.1, 0.1, 0.15), 12);
    ASSERT_TRUE(result.found) << "keyframe " << id;
    EXPECT_EQ(result.found->keyframe, id);
    EXPECT_GE(result.frames, 3) << "frames that took no part must agree";
    const SE3 truth = placeOf(id).inverse() * result.T_world_last;
    const SE3 error = truth.inverse() * result.found->hint.trajectory.T_reference_mid;
    EXPECT_LT(error.log().norm(), 0.01);
    EXPECT_NEAR(result.found->hint.trajectory.velocity(4), 0.4, 0.1);
    EXPECT_EQ(result.found->keyframe_frame->pyramid.level(0).intensity.size(), cv::Size(376, 240));
  }
}

TEST(Relocalizer, APlaceThatNoKeyframeSawIsNotTakenForAnother) {
  Relocalizer relocalizer = makeRelocalizer({});
  EXPECT_FALSE(search(relocalizer, placeOf(3) * moved(0.0, 0.0, 1.3), 12).found);
  // Nor is one that is seen from elsewhere: from afar and from behind.
  EXPECT_FALSE(search(relocalizer, placeOf(0) * moved(1.5, 0.0, 2.9), 12).found);
}

TEST(KeyframeArchive, KeepsSoManyAndDropsTheMostRedundant) {
  KeyframeArchive archive(3);
  const std::vector<double> yaws{0.0, 0.02, 1.1, 2.2};  // the first two are nearly the same view
  for (KeyframeId id = 0; id < 4; ++id) {
    const SE3 T_world_camera = test::roomSimulator().pose(1.0) * moved(0.0, 0.0, yaws.at(id));
    const SimulatedFrame rendered = renderAt(T_world_camera, Vector6::Zero(), 0.0);
    auto reference = test::makeReference(rendered, test::toFloat(rendered.sharp), 100);
    reference->id = {1, id, 0};
    reference->T_map_reference = T_world_camera;
    archive.add(*reference, *frameOf(rendered, 0.0));
  }
  EXPECT_EQ(archive.keyframes().size(), 3U);
  EXPECT_EQ(archive.keyframes().count(0) + archive.keyframes().count(1), 1U);
  EXPECT_EQ(archive.keyframes().count(2), 1U);
  EXPECT_EQ(archive.keyframes().count(3), 1U);
}

TEST(KeyframeArchive, RestoresTheImageToHalfAGreyLevel) {
  const SimulatedFrame rendered = renderAt(placeOf(0), Vector6::Zero(), 0.0);
  cv::Mat1f image = test::toFloat(rendered.sharp);
  image(3, 5) = std::nanf("");
  auto reference = test::makeReference(rendered, image, 100);
  const FrameConstPtr frame = test::makeFrame(image, 0, kExposure);
  reference->pyramid = std::shared_ptr<const ImagePyramid>(frame, &frame->pyramid);
  reference->exposure = kExposure;
  const ArchivedKeyframe kept(*reference, *frame);
  const FrameConstPtr restored = kept.restoreFrame();
  const cv::Mat1f& again = restored->pyramid.level(0).intensity;
  EXPECT_TRUE(std::isnan(again(3, 5)));
  EXPECT_EQ(cv::countNonZero(again == again), 240 * 376 - 1) << "NaN differs from itself";
  image(3, 5) = 0.0F;
  cv::Mat1f finite = again.clone();
  finite(3, 5) = 0.0F;
  cv::min(image, 254.0, image);
  EXPECT_LE(cv::norm(image, finite, cv::NORM_INF), 0.5);
  EXPECT_EQ(restored->exposure, kExposure);
  EXPECT_EQ(kept.restoreReference(restored)->points.size(), reference->points.size());
}

/// Its camera has the correction by then; what only its pixels could have of it, it still lacks.
TEST(KeyframeArchive, RestoresTheImageWithTheCalibrationThatIsKnownByThen) {
  const SimulatedFrame rendered = renderAt(placeOf(0), Vector6::Zero(), 0.0);
  auto reference = test::makeReference(rendered, test::toFloat(rendered.sharp), 100);
  ArchivedKeyframe kept(*reference, *frameOf(rendered, 0.0));
  CalibrationCorrection known;
  known.values(CalibrationCorrection::kFocal) = 0.01;
  known.values(CalibrationCorrection::kV1) = -0.3;
  const auto corrected = std::make_shared<ImagePyramid>(*reference->pyramid);
  corrected->correctCamera(pinholePart(known, corrected->level(0).camera));
  reference->pyramid = corrected;
  reference->correction = known;
  kept.update(*reference);
  const FrameConstPtr restored = kept.restoreFrame();
  EXPECT_EQ(restored->pyramid.level(0).camera.fx, corrected->level(0).camera.fx);
  const CalibrationCorrection lacking = restored->correction.lacks(known);
  EXPECT_NEAR(lacking[CalibrationCorrection::kFocal], 0.0, 1e-12);
  EXPECT_NEAR(lacking[CalibrationCorrection::kV1], -0.3, 1e-12);
}

/// A window that begins with it anew would else blur it once more.
TEST(KeyframeArchive, ADeblurredImageIsRestoredAsOneWithoutExposure) {
  const SimulatedFrame rendered = renderAt(placeOf(0), Vector6::Zero(), 0.0);
  auto reference = test::makeReference(rendered, test::toFloat(rendered.sharp), 100);
  reference->exposure = kExposure;
  EXPECT_EQ(ArchivedKeyframe(*reference, *frameOf(rendered, 0.0)).restoreFrame()->exposure, 0.0);
}

TEST(KeyframeArchive, TakesNewerPosesAndPointsOfWhatItKeeps) {
  KeyframeArchive archive(3);
  const SimulatedFrame rendered = renderAt(placeOf(0), Vector6::Zero(), 0.0);
  auto reference = test::makeReference(rendered, test::toFloat(rendered.sharp), 100);
  reference->id = {1, 7, 0};
  archive.update(*reference);
  EXPECT_TRUE(archive.keyframes().empty());
  archive.add(*reference, *frameOf(rendered, 0.0));
  reference->T_map_reference = moved(0.3, 0.0, 0.0);
  archive.update(*reference);
  EXPECT_NEAR(archive.keyframes().at(7).reference.T_map_reference.translation().x(), 0.3, 1e-12);
  EXPECT_EQ(archive.keyframes().at(7).reference.pyramid, nullptr);
}

TEST(KeyframeArchive, TakesTheSharpImageOfWhatItKeeps) {
  KeyframeArchive archive(3);
  const SimulatedFrame rendered = renderAt(placeOf(0), Vector6::Zero(), 0.0);
  const cv::Mat1f image = test::toFloat(rendered.sharp);
  auto reference = test::makeReference(rendered, image, 100);
  reference->id = {1, 7, 0};
  reference->exposure = kExposure;
  reference->image_xi.setConstant(0.01);
  const FrameConstPtr frame = test::makeFrame(image, 0, kExposure);
  reference->pyramid = std::shared_ptr<const ImagePyramid>(frame, &frame->pyramid);
  Reference sharp = *reference;
  sharp.pyramid = std::make_shared<const ImagePyramid>(image + 9.0F, test::roomSimulator().camera(), 5);
  sharp.image_xi.setZero();
  archive.replace(sharp, *frame);
  EXPECT_TRUE(archive.keyframes().empty()) << "it is not kept";
  archive.add(*reference, *frame);
  archive.replace(sharp, *frame);
  const ArchivedKeyframe& kept = archive.keyframes().at(7);
  EXPECT_EQ(kept.restoreFrame()->exposure, 0.0);
  EXPECT_TRUE(kept.reference.image_xi.isZero(0.0));
  EXPECT_NEAR(kept.restoreFrame()->pyramid.level(0).intensity(50, 60), image(50, 60) + 9.0F, 0.51F);
}

}  // namespace
}  // namespace mba_vo::relocalizer_test
