#pragma once

#include <vector>

#include "mba_vo/geometry/se3.h"

namespace mba_vo {

/// Estimate (already aligned) and truth at one instant.
struct PosePair {
  double time = 0.0;  // [s]
  SE3 groundtruth;
  SE3 estimate;
};

/// Angle between two orientations [deg].
double rotationDistance(const SE3& a, const SE3& b);

/// Absolute trajectory error: distance between positions [m].
std::vector<double> absoluteErrors(const std::vector<PosePair>& pairs);
/// Angle between orientations [deg].
std::vector<double> rotationErrors(const std::vector<PosePair>& pairs);

struct RelativeErrors {
  std::vector<double> translation;  // [m]
  std::vector<double> rotation;     // [deg]
};

/// Relative pose error (Sturm 2012): (Q_i^-1 Q_j)^-1 (P_i^-1 P_j) for every i, with j the pair nearest to
/// time_i + `interval` [s]; pairs further than `tolerance` [s] from it are left out.
RelativeErrors relativeErrors(const std::vector<PosePair>& pairs, double interval, double tolerance);

}  // namespace mba_vo
