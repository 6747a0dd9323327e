#pragma once

#include "mba_vo/solver/schur_complement.h"
#include "mba_vo/window/window_state.h"

namespace mba_vo {

/// Keeps points that the images do not place from coming ever nearer: its cost is w ((d - l) / c)^2 for every point
/// whose inverse depth d is above l = 4 c, c the median of all. On a fast turn there is hardly any parallax; without a
/// prior the inverse depth of some points grows without bounds, these then hold the translation at zero, and the scale
/// collapses. Most points never meet it, and a near one with parallax hardly feels it.
class NearDepthPenalty {
 public:
  /// With the median of the points' present inverse depths, which stays.
  explicit NearDepthPenalty(const WindowState& state);

  double cost(const WindowState& state) const;
  bool concerns(const PointState& point) const { return excess(point) > 0.0; }
  /// Adds Hessian and half the gradient of the inverse depth of the point in this row of the system.
  void addTo(const PointState& point, Eigen::Index row, LinearizedWindow& system) const;
  /// False for a point that is so much nearer than the others that it cannot be right.
  bool isPlausible(double inverse_depth) const;

 private:
  double excess(const PointState& point) const;  // over the limit [1/m]

  double median_ = 1.0;  // [1/m]
};

}  // namespace mba_vo
