#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "mba_vo/simulation/simulation_config.h"
#include "mba_vo/simulation/spline_motion.h"

namespace mba_vo {

/// The piece of a recorded motion that a configuration asks for, moved over the middle of a floor at z = 0.
class MotionPiece {
 public:
  /// Reads `config.motion`. Throws std::runtime_error as readMotionFile does, and std::invalid_argument naming what was
  /// asked for and what there is where the piece reaches beyond the file.
  explicit MotionPiece(const SimulationConfig& config);

  /// T_world_camera at t [s] after the middle of the first frame's exposure.
  SE3 pose(double t) const { return motion_.pose(first_frame_ + t); }

  /// From the middle of the first frame's exposure to the last instant at which a frame's may be, such that all
  /// exposures, rolled shutters included, lie within the piece [s].
  double span() const { return span_; }

  /// Where the camera is, neighbours at most 2.5 cm apart [m, world].
  std::vector<Eigen::Vector3d> path() const;

  /// Differs with every pose that can matter.
  std::uint64_t hash() const { return hash_; }

 private:
  MotionPiece(const SimulationConfig& config, const std::vector<TimedPose>& poses, double first_frame, double span);
  static MotionPiece cut(const SimulationConfig& config);

  double first_frame_;  // on the clock of the motion [s]
  double span_;         // [s]
  double margin_;       // of the piece before the first and after the last frame [s]
  std::uint64_t hash_;
  SplineMotion motion_;
};

}  // namespace mba_vo
