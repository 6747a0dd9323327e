#pragma once

#include <vector>

#include "mba_vo/solver/schur_complement.h"
#include "mba_vo/window/window_linearizer.h"

namespace mba_vo {

struct WindowMarginalizerOptions {
  int min_good_residuals = 3;              // of a point that enters the prior
  double min_relative_information = 50.0;  // inverse depth^2 times its information, of a point that enters the prior
};

/// Moves states that leave the window into the marginalisation prior.
class WindowMarginalizer {
 public:
  WindowMarginalizer(const WindowLinearizer& linearizer, const WindowMarginalizerOptions& options)
      : linearizer_(linearizer), options_(options) {}

  /// Points hosted by keyframe `host`: those well enough observed enter the prior, with Jacobians at the first
  /// estimates; all leave the window.
  void marginalizeHosted(WindowState& state, int host) const;
  /// The same for points of older keyframes which neither of the two newest keyframes sees any more.
  void marginalizeUnseen(WindowState& state) const;
  /// Eliminates the states of a keyframe that hosts no points; residuals of other points into it are dropped, as in
  /// DSO.
  void marginalizeKeyframe(WindowState& state, int keyframe) const;

 private:
  void marginalizePoints(WindowState& state, const std::vector<int>& points) const;
  bool wellObserved(const WindowState& state, const PointState& point) const;
  void connectObservers(WindowState& state, const std::vector<int>& points) const;

  WindowLinearizer linearizer_;
  WindowMarginalizerOptions options_;
};

}  // namespace mba_vo
