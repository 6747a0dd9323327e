#pragma once

#include <vector>

#include <Eigen/Core>

#include "mba_vo/simulation/scene.h"

namespace mba_vo {

/// Knows what stands too near to a path.
class Clearance {
 public:
  /// `path`: points [m, world]; `distance` [m] is to be kept from each.
  Clearance(std::vector<Eigen::Vector3d> path, double distance);

  bool violatedBy(const Surface& surface) const;

 private:
  struct Stretch {
    std::size_t begin, end;  // of the path
    Eigen::Vector3d center;
    double radius;  // [m]
  };

  std::vector<Eigen::Vector3d> path_;
  double distance_;
  std::vector<Stretch> stretches_;
};

/// Distance from a point to a rectangle [m].
double distanceTo(const Surface& surface, const Eigen::Vector3d& point);

}  // namespace mba_vo
