#include "mba_vo/tracking/exposure_by_rows.h"

#include <cmath>

#include <gtest/gtest.h>

namespace mba_vo::exposure_by_rows_test {
namespace {

constexpr int kState = AlignmentProblem::kLogExposure;
constexpr double kExpected = 0.01;      // [s]
constexpr double kExpectedSigma = 0.4;  // of its logarithm
constexpr double kScale = 20.0;         // variance of a residual, in which priors are counted [grey levels^2]
constexpr int kPatches = 100;           // each with a gradient of its own
constexpr double kSigma = 0.3;          // of the log exposure that the patches together tell
const double kPrior = kScale / (kExpectedSigma * kExpectedSigma);

/// At the minimum of `information` of the image about `log_exposure` and of the prior about 0.
struct Minimum {
  AlignmentProblem::Equations equations;
  AlignmentState state;

  Minimum(double information, double log_exposure) {
    equations.hessian.setIdentity();
    equations.hessian(kState, kState) = information + kPrior;
    equations.log_exposure_prior = kPrior;
    equations.prior_scatter(kState) = kScale * kPrior;
    for (int i = 0; i < kPatches; ++i) {
      equations.patch_gradients.emplace_back().fill(0.0);
      equations.patch_gradients.back()[kState] = information * kSigma / std::sqrt(kPatches);
    }
    state.log_exposure = information / (information + kPrior) * log_exposure;
  }
};

TEST(ExposureByRows, IsWhatTheImageSaysHoweverMuchTheExpectationCounts) {
  for (const double share : {0.9, 0.5, 0.1}) {
    for (const double log_exposure : {-0.5, 0.3}) {
      const Minimum minimum(share / (1.0 - share) * kPrior, log_exposure);
      const auto sample = exposureByRows(kExpected, minimum.state, minimum.equations);
      ASSERT_TRUE(sample) << share;
      EXPECT_NEAR(std::log(sample->exposure / kExpected), log_exposure, 1e-9) << share;
      EXPECT_NEAR(sample->log_sigma, kSigma, 1e-9) << share;
    }
  }
}

TEST(ExposureByRows, IsNothingWhereOnlyTheExpectationCountsOrNothingWasEstimated) {
  const Minimum weak(0.01 * kPrior, 0.3);
  EXPECT_FALSE(exposureByRows(kExpected, weak.state, weak.equations));
  Minimum fixed(kPrior, 0.3);
  fixed.equations.log_exposure_prior = 0.0;
  EXPECT_FALSE(exposureByRows(kExpected, fixed.state, fixed.equations));
}

}  // namespace
}  // namespace mba_vo::exposure_by_rows_test
