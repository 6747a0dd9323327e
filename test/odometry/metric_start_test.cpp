#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "mba_vo/evaluation/alignment.h"
#include "mba_vo/odometry/config_yaml.h"
#include "mba_vo/odometry/odometry.h"
#include "mba_vo/simulation/turning_first.h"
#include "support/rendered_sequence.h"

namespace mba_vo::metric_start_test {
namespace {

constexpr double kExposure = 0.03;  // [s] of 37 ms between frames
constexpr int kFrames = 70;

/// Blurred images with the true depths.
const test::RenderedSequence& sequence() {
  static const test::RenderedSequence sequence = [] {
    SimulationConfig config = test::sequenceConfig(kExposure);
    config.trajectory_seed = 3;
    config.depth = true;
    return test::renderFrames(config, 0, kFrames);
  }();
  return sequence;
}

using DepthOf = std::function<cv::Mat1f(const SimulatedFrame&)>;

cv::Mat1f trueDepth(const SimulatedFrame& frame) { return frame.depth; }

struct MetricRun {
  std::vector<TrajectoryEntry> trajectory;
  int first_map_after = -1;  // frames processed until there was a map
  int maps = 0;
  bool metric = true;  // all of them
  bool last_metric = false;
  double largest_error = 0.0;  // of the positions that were reported as good, relative to their keyframes [m]
};

/// Compares poses with the truth as they are reported.
class Witness {
 public:
  explicit Witness(const test::RenderedSequence& images) {
    for (const SimulatedFrame& frame : images.frames) T_world_frame_[frame.id] = frame.T_world_mid;
  }

  void add(const MapperOutput& output) {
    if (!output.reference) return;
    const ReferenceId& id = output.reference->id;
    if (output.reference->hint) keyframes_[{id.map_id, id.keyframe_id}] = output.reference->hint->frame_sequence;
    if (output.keyframe) keyframes_[{id.map_id, id.keyframe_id}] = output.keyframe->frame_sequence;
    if (output.reference->metric) metric_maps_.insert(id.map_id);
  }

  void add(const TrackedFrame& tracked) {
    if (tracked.status != TrackingStatus::kTracking || metric_maps_.count(tracked.reference.map_id) == 0) return;
    const auto keyframe = keyframes_.at({tracked.reference.map_id, tracked.reference.keyframe_id});
    const SE3 truth = T_world_frame_.at(keyframe).inverse() * T_world_frame_.at(tracked.frame->sequence);
    const Eigen::Vector3d error = tracked.trajectory.T_reference_mid.translation() - truth.translation();
    largest_ = std::max(largest_, error.norm());
  }

  double largest() const { return largest_; }

 private:
  std::map<std::uint64_t, SE3> T_world_frame_;
  std::map<std::pair<MapId, KeyframeId>, std::uint64_t> keyframes_;  // the frames they were
  std::set<MapId> metric_maps_;
  double largest_ = 0.0;
};

MetricRun run(const test::RenderedSequence& images, const DepthOf& depthOf) {
  OdometryConfig config;
  config.mapper.deterministic = true;
  finalize(config);
  const FrameBuilder builder(images.calibration, {}, config.image);
  Odometry odometry(config, 0);
  MetricRun result;
  Witness witness(images);
  MapId map = 0;
  int processed = 0;
  for (const SimulatedFrame& f : images.frames) {
    const OdometryResult step =
        odometry.process(builder.build(f.blurred, f.id, f.mid_exposure_ns, f.mid_exposure_ns, f.exposure, depthOf(f)));
    ++processed;
    for (const TrackedFrameConstPtr& late : step.late) witness.add(*late);
    witness.add(*step.tracked());
    for (const MapperOutput& output : step.mapping) {
      witness.add(output);
      if (!output.reference || output.reference->cause == ReferenceCause::kMapClosed) continue;
      if (output.reference->id.map_id != map) ++result.maps;
      map = output.reference->id.map_id;
      result.last_metric = output.reference->metric;
      result.metric = result.metric && output.reference->metric;
      if (result.first_map_after < 0) result.first_map_after = processed;
    }
  }
  odometry.finish();
  result.trajectory = odometry.trajectory();
  result.largest_error = witness.largest();
  return result;
}

struct Comparison {
  double scale = 0.0;    // true over estimated length
  double ate = 0.0;      // rms after alignment by a rigid motion [m]
  double largest = 0.0;  // distance from the truth, both relative to the first pose, nothing aligned [m]
};

Comparison compare(const std::vector<TrajectoryEntry>& trajectory, const test::RenderedSequence& images) {
  std::map<std::uint64_t, SE3> truth;
  for (const SimulatedFrame& frame : images.frames) truth[frame.id] = frame.T_world_mid;
  std::vector<Eigen::Vector3d> estimated, true_positions;
  for (const TrajectoryEntry& entry : trajectory) {
    estimated.push_back(entry.trajectory.T_reference_mid.translation());
    true_positions.push_back(truth.at(entry.frame_sequence).translation());
  }
  Comparison result;
  result.scale = alignPositions(estimated, true_positions, AlignmentMode::kSim3).scale;
  const Similarity rigid = alignPositions(estimated, true_positions, AlignmentMode::kSE3);
  const SE3 T_truth_map =
      truth.at(trajectory.front().frame_sequence) * trajectory.front().trajectory.T_reference_mid.inverse();
  double squares = 0.0;
  for (std::size_t i = 0; i < estimated.size(); ++i) {
    squares += (rigid * estimated[i] - true_positions[i]).squaredNorm();
    result.largest = std::max(result.largest, (T_truth_map * estimated[i] - true_positions[i]).norm());
  }
  result.ate = std::sqrt(squares / static_cast<double>(estimated.size()));
  return result;
}

TEST(MetricStart, TheFirstFrameIsInTheMapWhichIsInMetres) {
  const MetricRun with_depth = run(sequence(), trueDepth);
  ASSERT_EQ(with_depth.trajectory.size(), sequence().frames.size());
  EXPECT_EQ(with_depth.maps, 1);
  EXPECT_TRUE(with_depth.metric);
  EXPECT_LE(with_depth.first_map_after, 10);  // 0.3 s
  const Comparison accuracy = compare(with_depth.trajectory, sequence());
  EXPECT_NEAR(accuracy.scale, 1.0, 0.01);
  EXPECT_LT(accuracy.ate, 0.003);
  EXPECT_LT(with_depth.largest_error, 0.01);
  const MetricRun without = run(sequence(), [](const SimulatedFrame&) { return cv::Mat1f(); });
  EXPECT_FALSE(without.metric);
  EXPECT_GT(without.first_map_after, with_depth.first_map_after);
}

TEST(MetricStart, TheScaleIsThatOfTheDepths) {
  const MetricRun result = run(sequence(), [](const SimulatedFrame& f) { return cv::Mat1f(1.25 * f.depth); });
  ASSERT_EQ(result.trajectory.size(), sequence().frames.size());
  EXPECT_NEAR(compare(result.trajectory, sequence()).scale, 0.8, 0.008);
}

TEST(MetricStart, AFewDepthImagesAtTheBeginningAreEnough) {
  const MetricRun result = run(sequence(), [](const SimulatedFrame& f) { return f.id < 9 ? f.depth : cv::Mat1f(); });
  ASSERT_EQ(result.trajectory.size(), sequence().frames.size());
  EXPECT_TRUE(result.metric);
  EXPECT_NEAR(compare(result.trajectory, sequence()).scale, 1.0, 0.02);
}

TEST(MetricStart, DepthsOfAnotherSceneAreFoundOut) {
  const auto blocks = [](const SimulatedFrame& f) {
    cv::Mat1f depth(f.blurred.size());
    for (int y = 0; y < depth.rows; ++y) {
      for (int x = 0; x < depth.cols; ++x) depth(y, x) = (x / 47 + y / 40) % 2 == 0 ? 1.2F : 2.6F;
    }
    return depth;
  };
  const MetricRun result = run(sequence(), blocks);
  EXPECT_GE(result.maps, 1);
  EXPECT_FALSE(result.last_metric) << "they are still believed";
  constexpr double kMostWrong = 0.1;  // [m], 5 % of the scene's depth
  EXPECT_LT(result.largest_error, kMostWrong);
}

TEST(MetricStart, NeedsNoTranslation) {
  SimulationConfig config = test::sequenceConfig(0.01);
  config.depth = true;
  config.sharp = false;
  config.rate = 12.0;
  config.shake = 0.4;
  config.duration = 4.0;
  constexpr double kTurning = 2.5;  // [s]
  const Simulator simulator(config, sharedRoom());
  const TurningFirst motion(simulator, kTurning);
  test::RenderedSequence images{simulator.calibration(), {}};
  for (int i = 0; i < simulator.frames(); ++i) images.frames.push_back(motion.render(i));
  const MetricRun result = run(images, trueDepth);
  ASSERT_EQ(result.trajectory.size(), images.frames.size());
  EXPECT_EQ(result.maps, 1);
  EXPECT_LE(result.first_map_after, 5);
  const Comparison accuracy = compare(result.trajectory, images);
  EXPECT_LT(accuracy.largest, 0.02);
  EXPECT_NEAR(accuracy.scale, 1.0, 0.02);
}

}  // namespace
}  // namespace mba_vo::metric_start_test
