#pragma once

#include <vector>

#include <Eigen/Core>

#include "mba_vo/simulation/motion_file.h"

namespace mba_vo {

/// A smooth motion through given poses: natural cubic splines of the translation and of the quaternion, which is
/// normalised afterwards. Velocity and acceleration are continuous.
class SplineMotion {
 public:
  /// `poses`: at least two, in order of time.
  explicit SplineMotion(const std::vector<TimedPose>& poses);

  /// T_world_camera at t [s] on the clock of the poses. Before the first and after the last pose it stands still.
  SE3 pose(double t) const;

  double begin() const { return times_.front(); }  // [s]
  double end() const { return times_.back(); }     // [s]

 private:
  using Row = Eigen::Matrix<double, 1, 7>;  // translation [m], quaternion x y z w
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 7, Eigen::RowMajor>;

  void solveBends();

  std::vector<double> times_;
  Rows values_;
  Rows bends_;  // second derivatives [1/s^2]
};

}  // namespace mba_vo
