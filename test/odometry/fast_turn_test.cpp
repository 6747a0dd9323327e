#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "mba_vo/evaluation/alignment.h"
#include "mba_vo/odometry/config_yaml.h"
#include "mba_vo/odometry/odometry.h"
#include "support/rendered_sequence.h"

namespace mba_vo::fast_turn_test {
namespace {

constexpr double kExposure = 0.02;  // [s]
constexpr int kFirst = 35;
constexpr int kFrames = 90;
constexpr double kFastBlur = 18.0;  // [px] of 376: as 36 of 752

/// A hand that turns fast and back again.
SimulationConfig config() {
  SimulationConfig config = test::sequenceConfig(kExposure);
  config.trajectory_seed = 13;
  config.shake = 1.4;
  config.duration = 20.0;
  config.path_length = 12.0;
  return config;
}

const test::RenderedSequence& turns() {
  static const test::RenderedSequence sequence = test::renderFrames(config(), kFirst, kFrames);
  return sequence;
}

struct Outcome {
  int lost = 0;        // frames without a pose after the first one with one
  double ate = 0.0;    // after alignment by similarity [m]
  double worst = 0.0;  // of a frame [m]
};

Outcome run() {
  OdometryConfig options;
  options.mapper.deterministic = true;
  options.mapper.window.long_blur_px = 12.0;  // half of what it is at twice as many pixels
  finalize(options);
  Odometry odometry(options, 0);
  Outcome outcome;
  bool begun = false;
  for (const FrameConstPtr& frame : test::toFrames(turns(), false, kExposure)) {
    const bool tracked = odometry.process(frame).tracked()->tracked();
    begun = begun || tracked;
    if (begun && !tracked) ++outcome.lost;
  }
  odometry.finish();
  std::vector<Eigen::Vector3d> estimated, truth;
  for (const TrajectoryEntry& entry : odometry.trajectory()) {
    estimated.push_back(entry.trajectory.T_reference_mid.translation());
    truth.push_back(turns().frames.at(entry.frame_sequence - kFirst).T_world_mid.translation());
  }
  const Similarity alignment = alignPositions(estimated, truth, AlignmentMode::kSim3);
  double squares = 0.0;
  for (std::size_t i = 0; i < estimated.size(); ++i) {
    const double error = (alignment * estimated[i] - truth[i]).norm();
    squares += error * error;
    outcome.worst = std::max(outcome.worst, error);
  }
  outcome.ate = std::sqrt(squares / static_cast<double>(estimated.size()));
  return outcome;
}

TEST(FastTurn, IsTrackedToItsEndAndBack) {
  int fast = 0;
  for (const SimulatedFrame& frame : turns().frames) fast += frame.blur_px > kFastBlur ? 1 : 0;
  ASSERT_GE(fast, 8);
  const Outcome outcome = run();
  EXPECT_EQ(outcome.lost, 0);
  EXPECT_LT(outcome.ate, 0.015);
  EXPECT_LT(outcome.worst, 0.1);
}

}  // namespace
}  // namespace mba_vo::fast_turn_test
