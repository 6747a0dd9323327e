#include <gtest/gtest.h>

#include "mba_vo/evaluation/alignment.h"
#include "mba_vo/odometry/config_yaml.h"
#include "mba_vo/odometry/odometry.h"
#include "odometry/outcome.h"
#include "odometry/walk.h"

namespace mba_vo::loops_test {
namespace {

struct LoopRun {
  std::vector<test::Outcome> outcomes;  // of each frame, when it was tracked
  SmoothedTrajectory smoothed;
};

LoopRun runOver(bool close_loops) {
  OdometryConfig options;
  options.mapper.deterministic = true;
  options.mapper.loops.close = close_loops;
  finalize(options);
  Odometry odometry(options, 0);
  LoopRun run;
  for (const FrameConstPtr& frame : test::walkThereAndBack().frames) {
    const OdometryResult result = odometry.process(frame);
    for (const PublishedImage& image : result.images) {
      run.outcomes.push_back(test::outcomeOf(*image.step.message.tracked, image.step.T_odom_camera));
    }
  }
  odometry.finish();
  run.smoothed = odometry.mapper().smoothedTrajectory();
  return run;
}

/// Root mean square of the positions, after the best similarity [m].
double errorOf(const std::vector<TrajectoryEntry>& entries) {
  std::vector<Eigen::Vector3d> estimate, truth;
  for (const TrajectoryEntry& entry : entries) {
    estimate.push_back(entry.trajectory.T_reference_mid.translation());
    truth.push_back(test::walkThereAndBack().truth.at(entry.frame_sequence).translation());
  }
  const Similarity alignment = alignPositions(estimate, truth, AlignmentMode::kSim3);
  double sum = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) sum += (alignment * estimate[i] - truth[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(truth.size()));
}

TEST(Loops, CorrectTheSmoothedTrajectoryAndNothingElse) {
  const LoopRun without = runOver(false), with = runOver(true), again = runOver(true);
  test::expectSame(with.outcomes, without.outcomes);
  EXPECT_TRUE(without.smoothed.loops.empty());
  int closed = 0;
  for (const LoopTrial& loop : with.smoothed.loops) {
    if (loop.verdict.accepted()) ++closed;
  }
  EXPECT_GE(closed, 3);
  ASSERT_EQ(with.smoothed.entries.size(), without.smoothed.entries.size());
  EXPECT_LT(errorOf(with.smoothed.entries), 1.1 * errorOf(without.smoothed.entries) + 0.0005);
  ASSERT_EQ(again.smoothed.entries.size(), with.smoothed.entries.size());
  double moved = 0.0;
  for (std::size_t i = 0; i < with.smoothed.entries.size(); ++i) {
    const SE3& T = with.smoothed.entries[i].trajectory.T_reference_mid;
    moved += (T.translation() - without.smoothed.entries[i].trajectory.T_reference_mid.translation()).norm();
    EXPECT_EQ(T.log(), again.smoothed.entries[i].trajectory.T_reference_mid.log()) << "not repeatable";
  }
  EXPECT_GT(moved, 0.0);
}

}  // namespace
}  // namespace mba_vo::loops_test
