#pragma once

#include <vector>

#include <Eigen/Core>

#include "mba_vo/geometry/pinhole_camera.h"
#include "mba_vo/tracking/reference.h"

namespace mba_vo {

/// How the inverse depth changes across an image, from the points known there. On a plane inverse depth is linear in
/// the pixel, so the slope is that of a plane through the nearest points; points beyond a depth edge do not count, and
/// few or noisy points leave the surface fronto-parallel.
class SurfaceSlopes {
 public:
  SurfaceSlopes(const PinholeCamera& camera, const std::vector<ReferencePoint>& points);

  /// d inverse depth / d pixel [1 / (m px)] at a pixel of known inverse depth.
  Eigen::Vector2d at(const Eigen::Vector2d& pixel, double inverse_depth, double variance) const;

 private:
  struct Point {
    Eigen::Vector2d pixel;
    double inverse_depth;
  };
  struct Neighbour {
    double squared_distance;     // [px^2]
    Eigen::Vector2d offset;      // [px]
    double relative_difference;  // of the inverse depths
  };
  std::vector<Neighbour> neighbours(const Eigen::Vector2d& pixel, double inverse_depth) const;

  int columns_;
  int rows_;
  std::vector<std::vector<Point>> cells_;
};

}  // namespace mba_vo
