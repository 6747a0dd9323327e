#pragma once

#include <optional>
#include <vector>

#include "mba_vo/window/window_linearizer.h"

namespace mba_vo {

struct WindowPointActivationOptions {
  int max_iterations = 4;  // with the same keyframes
  double reach_px = 4.0;   // of a match along its epipolar line (docs/decisions/2026-11-29-within-reach.md)
  int min_good_residuals = 1;
  double min_good_fraction = 0.5;           // of the residuals whose patch is inside both images
  double min_relative_information = 100.0;  // inverse depth^2 times its information
  double min_relative_step = 1e-4;          // of the inverse depth; a smaller one is not worth a step
};

/// Finds the inverse depth of one point by Gauss-Newton on its residuals in the other keyframes, all poses fixed: first
/// in those with so little parallax that they show it within reach, then, as its depth becomes certain, in the others.
/// Out of reach a patch is compared with what happens to be there, and on smeared images most of that looks like it.
/// Returns the point with those residuals, or nothing if too few agree or the depth remains too uncertain.
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
  using Residuals = std::vector<PatchResidual>;

  /// Gives the point those of the residuals that come within reach, given how far its inverse depth may be off. False
  /// if none does.
  bool admit(const WindowState& state, const std::vector<PairGeometry>& pairs, double sigma, Residuals& waiting,
             PointState& point) const;
  /// By the residuals that the point has.
  Evaluation refine(const WindowState& state, const std::vector<PairGeometry>& pairs, PointState& point) const;
  Evaluation evaluate(const WindowState& state, const std::vector<PairGeometry>& pairs, bool place_pixels,
                      PointState& point) const;
  bool acceptable(const WindowState& state, const PointState& point, const Evaluation& evaluation) const;

  ResidualOptions residual_options_;
  WindowPointActivationOptions options_;
};

}  // namespace mba_vo
