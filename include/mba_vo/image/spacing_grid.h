#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "mba_vo/geometry/pinhole_camera.h"

namespace mba_vo {

/// Coarse occupancy of an image: at most one new point per cell of `distance_px`.
class SpacingGrid {
 public:
  SpacingGrid(const PinholeCamera& camera, double distance_px);
  bool isFree(const Eigen::Vector2d& pixel) const { return !occupied_[cell(pixel)]; }
  void occupy(const Eigen::Vector2d& pixel) { occupied_[cell(pixel)] = true; }

 private:
  std::size_t cell(const Eigen::Vector2d& pixel) const;
  double distance_px_;
  int columns_;
  int rows_;
  std::vector<bool> occupied_;
};

/// Spacing that brings `points` nearer to `wanted` the next time [px].
double adaptedDistance(double distance_px, int points, int wanted);

}  // namespace mba_vo
