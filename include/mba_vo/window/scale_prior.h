#pragma once

#include <Eigen/Core>

#include "mba_vo/window/window_state.h"

namespace mba_vo {

/// Holds the scale of the first window: its cost is w ((|t_a - t_b| - distance) / distance)^2 for two keyframes. Images
/// cannot tell the scale, so whatever w > 0 the minimum keeps the distance; w matters to the conditioning only.
class ScalePrior {
 public:
  explicit ScalePrior(double weight) : weight_(weight) {}

  bool active() const { return distance_ > 0.0; }
  /// Anchors the distance between the first keyframe and the one farthest from it, if there are two apart.
  void choose(const WindowState& state);
  double cost(const WindowState& state) const;
  /// Adds Hessian and half the gradient with Jacobians at the linearisation points.
  void addTo(const WindowState& state, Eigen::MatrixXd& H, Eigen::VectorXd& b) const;
  /// Hands the term over to the marginalisation prior and becomes inactive.
  void moveToPrior(WindowState& state);

 private:
  double weight_;
  KeyframeId first_ = 0;
  KeyframeId second_ = 0;
  double distance_ = 0.0;
};

}  // namespace mba_vo
