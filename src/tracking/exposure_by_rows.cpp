#include "mba_vo/tracking/exposure_by_rows.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace mba_vo {
namespace {

constexpr double kLeastShare = 0.02;  // of an estimate, that the image tells: with less it tells nothing

}  // namespace

std::optional<ExposureSample> exposureByRows(double expected, const AlignmentState& state,
                                             const AlignmentProblem::Equations& equations) {
  constexpr int kState = AlignmentProblem::kLogExposure;
  const double prior = equations.log_exposure_prior;
  if (prior == 0.0) return std::nullopt;
  const double share = 1.0 - prior * equations.hessian.inverse()(kState, kState);
  if (share < kLeastShare) return std::nullopt;
  const double of_prior = equations.prior_scatter(kState) / (prior * prior);
  const double variance = equations.covariance()(kState, kState) - (1.0 - share) * (1.0 - share) * of_prior;
  return ExposureSample{expected * std::exp(state.log_exposure / share), std::sqrt(std::max(variance, 0.0)) / share};
}

}  // namespace mba_vo
