#include "mba_vo/mapping/frame_refinement.h"

#include <cstdint>

#include <gtest/gtest.h>

#include "mapping/follower.h"

namespace mba_vo::test::frame_refinement_test {
namespace {

constexpr double kTurn = 0.02;  // by which a pose is wrong [rad]: 4 px

/// How far the pose of one frame between keyframes, told wrong, is from where it was at the end.
struct Outcome {
  double turned = 0.0;     // [rad]
  std::size_t frames = 0;  // in the trajectory
};

SE3 poseOf(const Mapper& mapper, std::uint64_t sequence) {
  for (const TrajectoryEntry& entry : mapper.trajectory()) {
    if (entry.frame_sequence == sequence) return entry.trajectory.T_reference_mid;
  }
  ADD_FAILURE() << "frame " << sequence << " is not in the trajectory";
  return {};
}

struct WrongPose {
  double expected_error_px = 1.0;  // that it is said to have
  double turn = kTurn;             // by which it is wrong [rad]
  double sigmas = 1.0;             // its standard deviations, over what they were
  int keyframes_before = 2;        // since the map began
  double least_blur_px = 0.0;      // of the frame
};

Outcome tellAWrongPose(const MapperConfig& config, const WrongPose& told,
                       const std::vector<FrameConstPtr>& images = frames()) {
  Mapper mapper(config);
  Follower follower(mapper, images);
  for (int i = 0; i < told.keyframes_before; ++i) follower.toNextKeyframe();
  follower.step();
  auto wrong = std::make_shared<TrackedFrame>(follower.track(follower.reference()));
  while (wrong->measures.blur_length_px < told.least_blur_px && !follower.atEnd()) {
    follower.step();
    wrong = std::make_shared<TrackedFrame>(follower.track(follower.reference()));
  }
  follower.step();
  const std::uint64_t sequence = wrong->frame->sequence;
  const SE3 right = poseOf(mapper, sequence);
  wrong->trajectory.T_reference_mid =
      wrong->trajectory.T_reference_mid * SE3::exp((Vector6() << 0.0, 0.0, 0.0, 0.0, told.turn, 0.0).finished());
  wrong->expected_error = told.expected_error_px;
  wrong->covariance *= told.sigmas * told.sigmas;
  mapper.process(wrong);  // as a frame that was tracked again
  EXPECT_NEAR((right.inverse() * poseOf(mapper, sequence)).log().norm(), told.turn, 1e-6);
  for (int i = 0; i < 2; ++i) EXPECT_NE(follower.toNextKeyframe().keyframe->frame_sequence, sequence);
  while (mapper.doDeferredWork()) {
  }
  return {(right.inverse() * poseOf(mapper, sequence)).log().tail<3>().norm(), mapper.trajectory().size()};
}

/// With keyframes some three images apart.
MapperConfig eager() {
  MapperConfig c = config();
  c.keyframe.flow_px = c.keyframe.parallax_px = 40.0;
  c.keyframe.sharp_blur_px = 100.0;
  return c;
}

TEST(FrameRefinement, CorrectsAFrameBetweenKeyframes) {
  const Outcome refined = tellAWrongPose(config(), WrongPose());
  EXPECT_LT(refined.turned, 0.1 * kTurn);
}

TEST(FrameRefinement, LeavesAFrameThatWasKnownBetter) {
  const Outcome left = tellAWrongPose(config(), {1e-6});
  EXPECT_GT(left.turned, 0.9 * kTurn);
}

TEST(FrameRefinement, MovesAFrameThatCannotBeTrackedBetterToWhereTheKeyframesSay) {
  double turned = 0.0;  // mean over frames that are more or less in the middle
  for (int keyframes_before = 1; keyframes_before <= 5; ++keyframes_before) {
    turned += 0.2 * tellAWrongPose(eager(), {1e-6, kTurn, 1000.0, keyframes_before}).turned;
  }
  EXPECT_LT(turned, 0.6 * kTurn) << "the place between keyframes is known to 0.01 rad";
}

/// Some 20 px of blur where the wrong pose is told.
std::vector<FrameConstPtr> framesOfATurn() {
  SimulationConfig c = sequenceConfig(0.036);
  c.shake = 1.5;
  c.duration = 3.0;
  return toFrames(renderFrames(c, 4, 46), false, c.exposure);
}

TEST(FrameRefinement, AlignsAFrameOfAFastTurnThatContradictsTheKeyframesAround) {
  // In a map that has grown: a young one would make a keyframe of the frame.
  const Outcome aligned = tellAWrongPose(eager(), {1e-6, 3.0 * kTurn, 1.0, 6, 16.0}, framesOfATurn());
  // 1.9 to 3.5 mrad of 60, by how the re-blurring kernel rounds.
  EXPECT_LT(aligned.turned, 0.25 * kTurn) << "however well it is said to be known: the keyframes know better";
  const Outcome slow = tellAWrongPose(eager(), {1e-6, 3.0 * kTurn});
  EXPECT_GT(slow.turned, 0.9 * kTurn);
}

TEST(FrameRefinement, CanBeSwitchedOff) {
  MapperConfig off = config();
  off.refine_frames = false;
  const Outcome left = tellAWrongPose(off, WrongPose());
  EXPECT_GT(left.turned, 0.9 * kTurn);
  EXPECT_EQ(left.frames, tellAWrongPose(config(), WrongPose()).frames) << "no frame may come or go by it";
}

}  // namespace
}  // namespace mba_vo::test::frame_refinement_test
