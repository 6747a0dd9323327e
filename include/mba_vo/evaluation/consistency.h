#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mba_vo/evaluation/online_log.h"
#include "mba_vo/evaluation/pose_file.h"

namespace mba_vo {

/// Squared error of one published pose over what its covariance expects, per degree of freedom: 1 on average over many
/// runs if the covariance is right, more if it promises too much.
struct NeesSample {
  double after = 0.0;           // the first pose of the map, as asked for [s]
  double total = 0.0;           // of 6 degrees of freedom
  double translation = 0.0;     // of 3
  double rotation = 0.0;        // of 3
  double position_error = 0.0;  // [m]
  double position_sigma = 0.0;  // root of the trace of the covariance [m]
  double rotation_error = 0.0;  // [deg]
  double rotation_sigma = 0.0;  // [deg]
  std::string unavailable;      // why the figures are NaN; empty if they are not
};

struct ConsistencyOptions {
  std::vector<double> times{1.0, 5.0, 10.0};  // after the first pose [s]
  bool fit_scale = true;                      // false: lengths of the odometry are metres
};

struct Consistency {
  int map = 0;            // with the most poses
  bool first_map = true;  // else the covariance includes the odometry before this map
  double scale = 1.0;     // metres per unit of the odometry, from the first 2 s
  std::vector<NeesSample> samples;
};

/// Error and covariance of published poses of the odometry, relative to the first published pose of the map that has
/// the most (see docs/evaluation.md for the definition). `groundtruth` and `odometry` sorted by time; the covariances
/// come from `frames` with the stamps of the poses.
Consistency measureConsistency(const std::vector<PoseRecord>& groundtruth, const std::vector<PoseRecord>& odometry,
                               const std::vector<OnlineFrame>& frames, const ConsistencyOptions& options);

}  // namespace mba_vo
