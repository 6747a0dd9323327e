#pragma once

#include <optional>

#include "mba_vo/mapping/window_linearizer.h"

namespace mba_vo {

struct WindowPointActivationOptions {
  int max_iterations = 4;
  int min_good_residuals = 1;
  double min_good_fraction = 0.5;           // of the residuals whose patch is inside both images
  double min_relative_information = 100.0;  // inverse depth^2 times its information
};

/// Finds the inverse depth of one point by Gauss-Newton on its residuals in all other keyframes, all poses fixed.
/// Returns the point with its residuals, or nothing if too few residuals agree or the depth remains too uncertain.
class WindowPointActivation {
 public:
  WindowPointActivation(const ResidualOptions& residual_options, bool reblur_targets,
                        const WindowPointActivationOptions& options)
      : residual_options_(residual_options), reblur_targets_(reblur_targets), options_(options) {}

  std::optional<PointState> activate(const WindowState& state, int host, const Eigen::Vector2d& pixel,
                                     double inverse_depth) const;

 private:
  struct DepthSystem;
  DepthSystem evaluate(const WindowState& state, const std::vector<PairGeometry>& pairs, bool place_pixels,
                       PointState& point) const;
  bool acceptable(const WindowState& state, const PointState& point, const DepthSystem& system) const;

  ResidualOptions residual_options_;
  bool reblur_targets_;
  WindowPointActivationOptions options_;
};

}  // namespace mba_vo
