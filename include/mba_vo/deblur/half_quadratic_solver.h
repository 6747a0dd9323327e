#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "mba_vo/deblur/blur_operator.h"

namespace mba_vo {

/// A blurred image as the solver needs it, all of the operator's observed size.
struct BlurredObservation {
  const BlurOperator* blur;
  cv::Mat1f image;   // [grey levels], any number, but no NaN, where the weight is 0
  cv::Mat1f weight;  // inverse variance [1 / grey level^2], 0 = unknown
};

struct HalfQuadraticConfig {
  float prior_weight = 0.2F;      // [1 / grey level]
  float first_coupling = 0.002F;  // of the gradient to its auxiliary variable [1 / grey level^2]
  float coupling_factor = 3.0F;   // from step to step
  int steps = 5;
  int iterations = 8;  // of conjugate gradients in a step
};

/// Minimises 1/2 sum weight (A L - B)^2 + prior_weight sum |gradient L| over the sharp image L by half-quadratic
/// splitting: an auxiliary variable takes the place of the gradient, drawn to it by a coupling that grows from step to
/// step. In each step it is the shrunken gradient, and L solves a linear system by conjugate gradients. `latent`, on
/// the operators' common grid, is where to begin, and the result.
void solveHalfQuadratic(const std::vector<BlurredObservation>& observations, const HalfQuadraticConfig& config,
                        cv::Mat1f& latent);

}  // namespace mba_vo
