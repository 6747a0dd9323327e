#pragma once

#include <optional>

#include "mba_vo/window/window_linearizer.h"

namespace mba_vo {

struct WindowPointActivationOptions {
  int max_iterations = 4;
  int min_good_residuals = 1;
  double min_good_fraction = 0.5;           // of the residuals whose patch is inside both images
  double min_relative_information = 100.0;  // inverse depth^2 times its information
  double min_relative_step = 1e-4;          // of the inverse depth; a smaller one is not worth a step
};

/// Finds the inverse depth of one point by Gauss-Newton on its residuals in all other keyframes, all poses fixed.
/// Returns the point with its residuals, or nothing if too few residuals agree or the depth remains too uncertain.
class WindowPointActivation {
 public:
  WindowPointActivation(const ResidualOptions& residual_options, const WindowPointActivationOptions& options)
      : residual_options_(residual_options), options_(options) {}

  /// `pairs`: of all keyframes at the current state.
  std::optional<PointState> activate(const WindowState& state, const std::vector<PairGeometry>& pairs,
                                     const NewPoint& candidate) const;

 private:
  struct Evaluation {
    double cost = 0.0;
    double H = 0.0;  // of the inverse depth
    double b = 0.0;
  };
  Evaluation evaluate(const WindowState& state, const std::vector<PairGeometry>& pairs, bool place_pixels,
                      PointState& point) const;
  bool acceptable(const WindowState& state, const PointState& point, const Evaluation& evaluation) const;

  ResidualOptions residual_options_;
  WindowPointActivationOptions options_;
};

}  // namespace mba_vo
