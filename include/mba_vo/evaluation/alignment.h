#pragma once

#include <vector>

#include <Eigen/Core>

#include "mba_vo/geometry/se3.h"

namespace mba_vo {

enum class AlignmentMode {
  kSim3,  // rotation, translation and scale
  kSE3    // rotation and translation
};

/// Similarity that maps the coordinates of the estimate to those of the ground truth: x -> scale R x + t.
struct Similarity {
  double scale = 1.0;
  SE3 motion;

  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const { return motion * Eigen::Vector3d(scale * x); }
  /// Pose of a camera: its position is scaled, its axes are only rotated.
  SE3 operator*(const SE3& T) const { return SE3(motion.rotation() * T.rotation(), (*this) * T.translation()); }
};

/// Least-squares alignment of positions (Umeyama 1991). An estimate that never moves gets scale 1 and no rotation.
/// Throws std::invalid_argument for fewer than three pairs or lists of different length.
Similarity alignPositions(const std::vector<Eigen::Vector3d>& estimate, const std::vector<Eigen::Vector3d>& groundtruth,
                          AlignmentMode mode);

}  // namespace mba_vo
