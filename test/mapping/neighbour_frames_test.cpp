#include "mba_vo/mapping/neighbour_frames.h"

#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "deblur/fake_deblurrers.h"
#include "mapping/follower.h"
#include "mapping/mapper_fixture.h"

namespace mba_vo::test::neighbour_frames_test {
namespace {

constexpr int kImages = 40;
constexpr double kExposure = 0.02;  // [s]
constexpr double kDarker = 0.8;     // every other image

const RenderedSequence& rendered() {
  static const RenderedSequence kSequence = [] {
    SimulationConfig simulation = sequenceConfig(kExposure);
    simulation.trajectory_seed = 3;
    return renderFrames(simulation, 0, kImages);
  }();
  return kSequence;
}

double brightnessOf(std::uint64_t sequence) { return sequence % 2 == 0 ? 1.0 : kDarker; }

std::vector<FrameConstPtr> images(std::optional<double> exposure) {
  RenderedSequence sequence = rendered();
  for (SimulatedFrame& frame : sequence.frames) frame.blurred = brightnessOf(frame.id) * frame.blurred;
  return toFrames(sequence, false, exposure);
}

const SimulatedFrame& truthOf(std::uint64_t sequence) {
  return rendered().frames.at(sequence - rendered().frames.front().id);
}

/// What the deblurrer is given of a walk through the images.
struct Walk {
  std::vector<DeblurInput> inputs;
  std::uint64_t first_tracked = 0;  // frame; those before it made the map
};

Walk walkThrough(int frames, std::optional<double> exposure) {
  MapperConfig c = config();
  c.deblur.method = "trajectory";
  c.deblur.trajectory.frames = frames;
  c.deblur_queue.per_second = 1000.0;
  const auto leavesAll = [](const DeblurInput& input) {
    DeblurResult result;
    result.image = input.image;
    return result;
  };
  const auto deblurrer = std::make_shared<FakeDeblurrer>(leavesAll);
  Mapper mapper(c, deblurrer);
  const std::vector<FrameConstPtr> walk = images(exposure);
  Follower follower(mapper, walk);
  const std::uint64_t first_tracked = follower.nextSequence();
  while (!follower.atEnd()) follower.step();
  return {deblurrer->inputs(), first_tracked};
}

SE3 trueMotion(const DeblurInput& input, const DeblurNeighbour& neighbour) {
  return truthOf(input.sequence).T_world_mid.inverse() * truthOf(neighbour.sequence).T_world_mid;
}

/// Of the map: its unit of length over the metre.
double scaleOf(const DeblurInput& input) {
  double estimated = 0.0;
  double real = 0.0;
  for (const DeblurNeighbour& neighbour : input.neighbours) {
    estimated += neighbour.motion.T_reference_mid.translation().norm();
    real += trueMotion(input, neighbour).translation().norm();
  }
  return estimated / real;
}

double meanInverseDepth(const DeblurInput& input) {
  double sum = 0.0;
  for (const DepthSample& sample : input.depths) sum += static_cast<double>(sample.inverse_depth);
  return sum / static_cast<double>(input.depths.size());
}

/// [frames] from the keyframe: two before it, as far as they were tracked, and the one after.
std::vector<int> neighboursSince(std::uint64_t first_tracked, std::uint64_t keyframe) {
  if (keyframe <= first_tracked) return {1};
  if (keyframe == first_tracked + 1) return {-1, 1};
  return {-2, -1, 1};
}

TEST(NeighbourFrames, AreWhereTheyWere) {
  const auto [all, first_tracked] = walkThrough(2, kExposure);
  ASSERT_GT(all.size(), 3U);
  EXPECT_TRUE(all.front().neighbours.empty()) << "the first keyframe of the map";
  for (std::size_t i = 1; i < all.size(); ++i) {
    std::vector<int> distances;
    for (const DeblurNeighbour& neighbour : all[i].neighbours) {
      distances.push_back(static_cast<int>(neighbour.sequence) - static_cast<int>(all[i].sequence));
      const SimulatedFrame& frame = truthOf(neighbour.sequence);
      const SE3 truth = trueMotion(all[i], neighbour);
      const SE3& pose = neighbour.motion.T_reference_mid;
      EXPECT_LT((truth.inverse() * pose).log().tail<3>().norm(), 0.003);
      const Eigen::Vector3d error = pose.translation() - scaleOf(all[i]) * truth.translation();
      EXPECT_LT(meanInverseDepth(all[i]) * error.norm(), 0.003);
      const Vector6 turn = (frame.T_world_start.inverse() * frame.T_world_end).log() / kExposure;
      EXPECT_LT((neighbour.motion.velocity - turn).tail<3>().norm(), 0.2 * turn.tail<3>().norm() + 0.05);
      EXPECT_EQ(neighbour.motion.exposure, kExposure);
      const double gain = brightnessOf(neighbour.sequence) / brightnessOf(all[i].sequence);
      EXPECT_NEAR(100.0 * neighbour.gain + neighbour.offset, 100.0 * gain, 3.0);
      EXPECT_EQ(neighbour.image->level(0).intensity.size(), all[i].image->level(0).intensity.size());
    }
    EXPECT_EQ(distances, neighboursSince(first_tracked, all[i].sequence)) << all[i].sequence;
  }
}

TEST(NeighbourFrames, AreNotKeptWhereOneFrameIsEnough) {
  for (const DeblurInput& input : walkThrough(1, kExposure).inputs) EXPECT_TRUE(input.neighbours.empty());
}

TEST(NeighbourFrames, HaveKnownExposures) {
  const std::vector<DeblurInput> all = walkThrough(2, std::nullopt).inputs;
  ASSERT_GT(all.size(), 1U);
  for (const DeblurInput& input : all) EXPECT_TRUE(input.neighbours.empty());
}

}  // namespace
}  // namespace mba_vo::test::neighbour_frames_test
