#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "mba_vo/evaluation/availability.h"
#include "mba_vo/evaluation/consistency.h"
#include "mba_vo/evaluation/evaluator.h"
#include "mba_vo/evaluation/run_folder.h"

namespace mba_vo {

/// The figures of one trajectory of a run, or why there are none.
struct TrajectoryFigures {
  std::optional<EvaluationReport> report;
  std::string unavailable;
};

/// Distance of the scene, over which parallax is counted.
struct SceneDepth {
  enum class Source { kGiven, kOnline, kSmoothed, kAssumed };
  double metres = 0.0;
  Source source = Source::kAssumed;
};

struct RunOptions {
  EvaluationOptions evaluation;
  std::optional<double> depth;               // median of the scene [m]; nullopt: from the scale of the map
  std::vector<double> nees_times{1, 5, 10};  // [s]
};

/// A run judged by what it published when it published it, and beside that by the trajectory it saved in the end.
struct RunReport {
  AlignmentMode mode = AlignmentMode::kSim3;
  TrajectoryFigures trajectory;  // online, camera to map
  TrajectoryFigures odometry;    // online, camera to odom
  TrajectoryFigures smoothed;
  Availability availability;
  Consistency consistency;
  SceneDepth depth;
  bool metric = false;                  // lengths of the map are metres: its scale does not tell the depth
  std::optional<double> parallax_time;  // when the camera had moved by 2 % of the depth [s]; nullopt: never
  std::size_t logged_without_pose = 0;  // images with a pose by frames.csv, none in online_odometry.txt
  int restarts = 0;                     // before this run, which knew what they had learnt
};

/// Throws std::runtime_error if there are poses, but none of the trajectories can be compared with the ground truth.
RunReport evaluateRun(const std::vector<PoseRecord>& groundtruth, const RunFolder& run, const RunOptions& options);

}  // namespace mba_vo
