#include "mba_vo/mapping/calibration_estimator.h"

#include <Eigen/Cholesky>

namespace mba_vo {
namespace {

constexpr int kLeastWindows = 4;
constexpr int kSettledWindows = 8;  // without a step: some two seconds of a hand-held camera
// Pixels, patches of a point, and windows that share keyframes are far from independent, and what no model explains is
// the same in many. The scatter of the windows' estimates is some ten times what the residuals alone would have.
constexpr double kCorrelation = 50.0;
// Of six degrees of freedom, 95 %. Right calibrations stayed below 5; where 50 was waited for,
// the scale of kitchen had drifted by a fifth before a first step was taken (docs/decisions/2026-11-21-calibration.md).
constexpr double kSignificant = 12.6;  // chi^2 of a step worth taking
// The same of three. Right cameras took steps of up to 0.6 % of the light; true vignettes a first one of 8 to 20 %.
constexpr double kSignificantVignette = 7.8;
// Five standard deviations: what is not told of a shutter is far from what was taken for it, or right.
constexpr double kSignificantReadout = 25.0;
constexpr int kVignette = CalibrationCorrection::kVignetteDim;
constexpr int kReadout = CalibrationCorrection::kReadout;

CalibrationCorrection::Vector priorSigma() {
  CalibrationCorrection::Vector sigma;
  sigma << 0.03, 0.02, 0.02, 0.05, 0.05, 0.015, 0.5, 0.5, 0.5;
  return sigma;
}

}  // namespace

bool CalibrationEstimator::add(const CalibrationSystem& system) {
  sum_.H += system.H / kCorrelation;
  sum_.b += system.b / kCorrelation;
  if (vignette_ == Vignette::kTold) {
    sum_.H.rightCols<kVignette>().setZero();
    sum_.H.bottomRows<kVignette>().setZero();
    sum_.b.tail<kVignette>().setZero();
  }
  ++windows_;
  if (correctVignette() || correctReadout() || (windows_ >= kLeastWindows && correctGeometry())) {
    sum_ = {};
    windows_ = 0;
    return true;
  }
  if (windows_ >= kSettledWindows) settled_ = correction_;
  return false;
}

CalibrationSystem CalibrationEstimator::withPrior() const {
  const CalibrationCorrection::Vector prior = priorSigma().array().square().inverse();
  CalibrationSystem system = sum_;
  system.H.diagonal() += prior;
  system.b += prior.cwiseProduct(correction_.values);
  return system;
}

/// Of the vignette alone, whatever the geometry is: until the brightness is right, it speaks for a wrong geometry.
bool CalibrationEstimator::correctVignette() {
  const CalibrationSystem system = withPrior();
  const CalibrationCorrection::Matrix covariance = system.H.ldlt().solve(CalibrationCorrection::Matrix::Identity());
  const CalibrationCorrection::Vignette step = -(covariance * system.b).tail<kVignette>();
  const auto of_vignette = covariance.bottomRightCorner<kVignette, kVignette>().ldlt();
  if (!(step.dot(of_vignette.solve(step)) > kSignificantVignette)) return false;
  correction_.values.tail<kVignette>() += step;
  return true;
}

/// Of the read-out time alone, whatever the rest is: a map that is made without it goes wrong from the beginning.
bool CalibrationEstimator::correctReadout() {
  if (correction_.values(kReadout) != 0.0) return false;
  const CalibrationSystem system = withPrior();
  const CalibrationCorrection::Vector covariances =
      system.H.ldlt().solve(CalibrationCorrection::Vector::Unit(kReadout));
  const double step = -covariances.dot(system.b);
  if (!(step * step > kSignificantReadout * covariances(kReadout))) return false;
  correction_.values(kReadout) += step;
  return true;
}

/// Of the geometry, and the rest of the vignette with it. A shutter is what it was taken for until its rows alone say
/// otherwise.
bool CalibrationEstimator::correctGeometry() {
  CalibrationSystem system = withPrior();
  if (correction_.values(kReadout) == 0.0) {
    system.H.row(kReadout).setZero();
    system.H.col(kReadout).setZero();
    system.H(kReadout, kReadout) = 1.0;
    system.b(kReadout) = 0.0;
  }
  const CalibrationCorrection::Vector step = -system.H.ldlt().solve(system.b);
  if (!(step.dot(system.H * step) > kSignificant)) return false;
  correction_.values += step;
  return true;
}

}  // namespace mba_vo
