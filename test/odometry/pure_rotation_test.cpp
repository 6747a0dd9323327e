#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "mba_vo/evaluation/alignment.h"
#include "mba_vo/odometry/config_yaml.h"
#include "mba_vo/odometry/odometry.h"
#include "mba_vo/simulation/turning_first.h"
#include "simulation/test_scenes.h"

namespace mba_vo::pure_rotation_test {
namespace {

constexpr double kTurning = 10.0;  // [s]
constexpr double kWalking = 3.0;   // [s]
constexpr double kDegrees = 180.0 / M_PI;

SimulationConfig slowCamera() {
  SimulationConfig config;
  config.resize(376, 240);
  config.rate = 12.0;
  config.exposure = 0.01;
  config.shake = 0.4;
  config.duration = kTurning + kWalking;
  return config;
}

/// Largest distance from the truth after alignment by a similarity, in units of the true path.
double largestError(const std::vector<TrajectoryEntry>& trajectory, const std::map<std::uint64_t, SE3>& truth) {
  std::vector<Eigen::Vector3d> estimated, true_positions;
  double path = 0.0;
  for (const TrajectoryEntry& entry : trajectory) {
    estimated.push_back(entry.trajectory.T_reference_mid.translation());
    true_positions.push_back(truth.at(entry.frame_sequence).translation());
    if (true_positions.size() > 1) path += (true_positions.back() - true_positions[true_positions.size() - 2]).norm();
  }
  const Similarity alignment = alignPositions(estimated, true_positions, AlignmentMode::kSim3);
  double largest = 0.0;
  for (std::size_t i = 0; i < estimated.size(); ++i) {
    const SE3 pose = alignment * SE3(Eigen::Quaterniond::Identity(), estimated[i]);
    largest = std::max(largest, (pose.translation() - true_positions[i]).norm());
  }
  return largest / path;
}

TEST(PureRotation, MakesNoMapUntilTheCameraWalks) {
  const Simulator simulator(slowCamera(), sharedRoom());
  const TurningFirst motion(simulator, kTurning);
  OdometryConfig config;
  config.mapper.deterministic = true;
  finalize(config);
  const FrameBuilder builder(simulator.calibration(), {}, config.image);
  Odometry odometry(config, 0);
  std::map<std::uint64_t, SE3> truth;
  double turned = 0.0;  // [deg]
  double map_at = 0.0;  // [s]
  for (int i = 0; i < simulator.frames(); ++i) {
    const SimulatedFrame frame = motion.render(i);
    truth[frame.id] = frame.T_world_mid;
    const OdometryResult result = odometry.process(
        builder.build(frame.blurred, frame.id, frame.mid_exposure_ns, frame.mid_exposure_ns, frame.exposure));
    for (const MapperOutput& output : result.mapping) {
      if (output.reference && map_at == 0.0) map_at = simulator.time(i);
    }
    if (simulator.time(i) > kTurning) continue;
    ASSERT_EQ(map_at, 0.0) << "a map was invented";
    ASSERT_EQ(result.tracked()->status, TrackingStatus::kInitializing);
    EXPECT_TRUE(result.tracked()->orientation_only) << "frame " << i;
    const SE3 T_first_frame = truth.at(0).inverse() * frame.T_world_mid;
    const SE3& estimated = result.tracked()->trajectory.T_reference_mid;
    EXPECT_LT(kDegrees * estimated.rotation().angularDistance(T_first_frame.rotation()), 1.0) << "frame " << i;
    turned = std::max(turned, kDegrees * T_first_frame.rotation().angularDistance(SE3().rotation()));
  }
  odometry.finish();
  EXPECT_GT(turned, 30.0) << "no test";
  EXPECT_GT(map_at, kTurning);
  EXPECT_LT(map_at, kTurning + TurningFirst::kOnset + 1.5);
  ASSERT_FALSE(odometry.trajectory().empty());
  EXPECT_LT(largestError(odometry.trajectory(), truth), 0.03);
}

}  // namespace
}  // namespace mba_vo::pure_rotation_test
