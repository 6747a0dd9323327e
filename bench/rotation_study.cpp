// A camera that only turns for 10 s and then walks for 4 s: how well is its orientation known, is a map invented, and
// how soon does the right one begin?
//   rotation_study [FIRST_SEED LAST_SEED [SHAKE [ZOOM]]]
// Every seed chooses both room and motion; ZOOM 1 are images of 752x480.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/utility.hpp>

#include "mba_vo/evaluation/alignment.h"
#include "mba_vo/odometry/config_yaml.h"
#include "mba_vo/odometry/odometry.h"
#include "mba_vo/simulation/turning_first.h"

namespace mba_vo {
namespace {

constexpr double kTurning = 10.0;        // [s]
constexpr double kWalking = 4.0;         // [s]
constexpr double kLeastParallax = 0.02;  // of the median depth
constexpr double kDegrees = 180.0 / M_PI;

struct Study {
  int frames = 0;                  // while it only turns
  int measured = 0;                // of them, with an orientation
  double turned = 0.0;             // farthest from the first view [deg]
  double error = 0.0;              // of the orientation, largest [deg]
  int invented = 0;                // maps
  std::optional<double> parallax;  // time of the first 2 % [s]
  std::optional<double> map;       // time of the first map after that [s]
  double ate = 0.0;                // of the frames after it, of the path [%]
};

double medianDepth(const cv::Mat1f& depth) {
  std::vector<float> values(depth.begin(), depth.end());
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

double degreesBetween(const SE3& a, const SE3& b) { return kDegrees * a.rotation().angularDistance(b.rotation()); }

/// Share of the path by which the poses after the first map are off.
double errorAfter(const std::vector<TrajectoryEntry>& trajectory, const std::map<std::uint64_t, SE3>& truth) {
  std::vector<Eigen::Vector3d> estimated, true_positions;
  double path = 0.0;
  for (const TrajectoryEntry& entry : trajectory) {
    if (1e-9 * static_cast<double>(entry.mid_exposure_ns) < kTurning) continue;
    estimated.push_back(entry.trajectory.T_reference_mid.translation());
    true_positions.push_back(truth.at(entry.frame_sequence).translation());
    if (true_positions.size() > 1) path += (true_positions.back() - true_positions[true_positions.size() - 2]).norm();
  }
  if (estimated.size() < 3) return 100.0;
  const Similarity alignment = alignPositions(estimated, true_positions, AlignmentMode::kSim3);
  double squares = 0.0;
  for (std::size_t i = 0; i < estimated.size(); ++i) {
    const SE3 pose = alignment * SE3(Eigen::Quaterniond::Identity(), estimated[i]);
    squares += (pose.translation() - true_positions[i]).squaredNorm();
  }
  return 100.0 * std::sqrt(squares / static_cast<double>(estimated.size())) / path;
}

void takeTurning(const OdometryResult& result, const SE3& T_first_frame, Study& study) {
  ++study.frames;
  study.measured += result.tracked()->orientation_only ? 1 : 0;
  study.turned = std::max(study.turned, degreesBetween(SE3(), T_first_frame));
  study.error = std::max(study.error, degreesBetween(result.tracked()->trajectory.T_reference_mid, T_first_frame));
  for (const MapperOutput& output : result.mapping) study.invented += output.reference ? 1 : 0;
}

Study runOver(const SimulationConfig& simulation) {
  OdometryConfig config;
  finalize(config);
  config.mapper.deterministic = true;
  const Simulator simulator(simulation);
  const TurningFirst motion(simulator, kTurning);
  const FrameBuilder builder(simulator.calibration(), {}, config.image);
  Odometry odometry(config, 0);
  std::map<std::uint64_t, SE3> truth;
  Study study;
  double depth = 0.0;
  for (int i = 0; i < simulator.frames(); ++i) {
    const SimulatedFrame frame = motion.render(i);
    if (i == 0) depth = medianDepth(frame.depth);
    truth[frame.id] = frame.T_world_mid;
    const SE3 T_first_frame = truth.begin()->second.inverse() * frame.T_world_mid;
    const OdometryResult result = odometry.process(
        builder.build(frame.blurred, frame.id, frame.mid_exposure_ns, frame.mid_exposure_ns, frame.exposure));
    const double now = simulator.time(i);
    if (now <= kTurning) takeTurning(result, T_first_frame, study);
    if (!study.parallax && T_first_frame.translation().norm() >= kLeastParallax * depth) study.parallax = now;
    for (const MapperOutput& output : result.mapping) {
      if (output.reference && !study.map && now > kTurning) study.map = now;
    }
  }
  odometry.finish();
  study.ate = errorAfter(odometry.trajectory(), truth);
  return study;
}

int run(int argc, char** argv) {
  const int first = argc > 1 ? std::atoi(argv[1]) : 1;
  const int last = argc > 2 ? std::atoi(argv[2]) : 4;
  SimulationConfig simulation;
  simulation.depth = true;
  simulation.duration = kTurning + kWalking;
  simulation.shake = argc > 3 ? std::atof(argv[3]) : 1.0;
  const double zoom = argc > 4 ? std::atof(argv[4]) : 0.5;
  simulation.resize(static_cast<int>(zoom * simulation.width), static_cast<int>(zoom * simulation.height));
  std::printf(
      "| seed | turned [deg] | orientation measured | its error, largest [deg] | maps invented | from 2 %% of "
      "parallax to the map [s] | ATE after that [%% of the path] |\n|---|---|---|---|---|---|---|\n");
  for (int seed = first; seed <= last; ++seed) {
    simulation.scene_seed = simulation.trajectory_seed = seed;
    const Study study = runOver(simulation);
    const double delay = study.map && study.parallax ? *study.map - *study.parallax : NAN;
    std::printf("| %d | %.0f | %.1f %% | %.2f | %d | %.2f | %.2f |\n", seed, study.turned,
                100.0 * study.measured / study.frames, study.error, study.invented, delay, study.ate);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace mba_vo

int main(int argc, char** argv) {
  cv::setNumThreads(2);
  return mba_vo::run(argc, argv);
}
