#include "mba_vo/io/calibration_estimate.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace mba_vo::calibration_estimate_test {
namespace {

using Correction = CalibrationCorrection;

constexpr double kCorrelation = 50.0;  // residuals count for so much less

Correction truth() {
  Correction correction;
  correction.values << 0.01, -0.004, 0.003, 0.02, -0.01, 5e-6, -0.2, -0.1, -0.05;
  return correction;
}

/// Of one number, in its own unit.
Correction::Vector scale() {
  Correction::Vector scale;
  scale << 2e-3, 2e-3, 2e-3, 1e-2, 1e-2, 1e-6, 5e-2, 5e-2, 5e-2;
  return scale;
}

/// What a window says whose estimate is off by as much as it is expected to be.
KeyframeReport window(const Correction& present, cv::RNG& rng, double noise) {
  CalibrationSystem system;
  Correction::Vector error;
  for (int i = 0; i < Correction::kDim; ++i) {
    system.H(i, i) = kCorrelation / std::pow(scale()(i), 2);
    error(i) = noise * rng.gaussian(1.0) * scale()(i);
  }
  system.b = -system.H * (truth().values + error - present.values);
  KeyframeReport report;
  report.calibration = {present, system};
  return report;
}

std::vector<KeyframeReport> run(int windows, std::uint64_t seed, double noise = 1.0) {
  cv::RNG rng(seed);
  std::vector<KeyframeReport> reports(1);  // the first keyframe says nothing
  for (int i = 0; i < windows; ++i) {
    Correction present;
    if (i > windows / 3) present.values = 0.9 * truth().values;  // stepped meanwhile
    reports.push_back(window(present, rng, noise));
  }
  return reports;
}

TEST(CalibrationEstimate, AllWindowsTellTogetherWhateverCorrectionTheyHad) {
  const CalibrationEstimate estimate = estimateCalibration(run(40, 1, 0.0), 41, {});
  EXPECT_EQ(estimate.windows, 40);
  for (int i = 0; i < Correction::kDim; ++i) {
    EXPECT_NEAR(estimate.correction.values(i), truth().values(i), 0.05 * scale()(i)) << i;  // there is a weak prior
    EXPECT_NEAR(estimate.sigma()(i), scale()(i) / std::sqrt(40.0), 0.02 * scale()(i)) << i;
  }
}

TEST(CalibrationEstimate, ErrorsAreWithinTheirStandardDeviations) {
  double squares = 0.0;
  constexpr int kRuns = 40;
  for (int seed = 1; seed <= kRuns; ++seed) {
    const CalibrationEstimate estimate = estimateCalibration(run(40, static_cast<std::uint64_t>(seed)), 41, {});
    squares += estimate.chi2(truth());
  }
  EXPECT_GT(squares / kRuns, 0.4 * Correction::kDim);
  EXPECT_LT(squares / kRuns, 1.3 * Correction::kDim);
}

TEST(CalibrationEstimate, WindowsThatContradictEachOtherTellLess) {
  const Correction::Vector agreeing = estimateCalibration(run(40, 3, 0.5), 41, {}).sigma();
  const Correction::Vector contradicting = estimateCalibration(run(40, 3, 5.0), 41, {}).sigma();
  EXPECT_GT(contradicting.cwiseQuotient(agreeing).mean(), 3.0);
}

TEST(CalibrationEstimate, TheFirstKeyframesAlone) {
  EXPECT_EQ(estimateCalibration(run(40, 1), 11, {}).windows, 10);
  EXPECT_EQ(estimateCalibration(run(40, 1), 1, {}).windows, 0);
  EXPECT_GT(estimateCalibration(run(40, 1), 11, {}).sigma()(0), estimateCalibration(run(40, 1), 41, {}).sigma()(0));
}

TEST(CalibrationEstimate, UnderARollingShutterLessIsSure) {
  const Correction::Vector still = estimateCalibration(run(10, 1), 11, {}).sigma();
  const Correction::Vector rolling = estimateCalibration(run(10, 1), 11, {false, true}).sigma();
  EXPECT_GT(rolling.cwiseQuotient(still).minCoeff(), 3.0);
}

TEST(CalibrationEstimate, AVignetteThatIsToldStays) {
  const CalibrationEstimate estimate = estimateCalibration(run(40, 1), 41, {true, false});
  EXPECT_TRUE(estimate.correction.vignette().isZero(1e-12));
  EXPECT_NEAR(estimate.correction[Correction::kFocal], truth()[Correction::kFocal], 3.0 * estimate.sigma()(0));
}

}  // namespace
}  // namespace mba_vo::calibration_estimate_test
