#include "mba_vo/mapping/calibration_estimator.h"

#include <array>

#include <Eigen/Cholesky>

namespace mba_vo {
namespace {

constexpr int kLeastWindows = 4;
constexpr int kSettledWindows = 8;  // without a step that counts: some two seconds of a hand-held camera
// Pixels, patches of a point, and windows that share keyframes are far from independent, and what no model explains is
// the same in many. The scatter of the windows' estimates is some ten times what the residuals alone would have.
constexpr double kCorrelation = 50.0;
// Quantiles of chi^2 by degrees of freedom, 97.5 %. In 42 runs of 21 sequences right lenses stayed below 1.9 of one,
// apart from two first maps under a rolling shutter that nobody had told
// (docs/decisions/2026-11-30-steps-of-the-lens.md).
constexpr std::array<double, 7> kChance{0.0, 5.0, 7.4, 9.3, 11.1, 12.8, 14.4};
// Centre and distortion need more: young maps under a rolling shutter had up to 1.5 times what is chance at a first
// step, kitchen, whose lens is wrong, has 5 times.
constexpr double kBeyondFocalLength = 3.0;
// Of a lens that is known to be wrong whatever lowers the cost is welcome, if by more than the noise of ten windows.
constexpr double kWorthwhile = 0.2;  // chi^2
// What a window weighs when the next one comes. Of a lens that is known to be wrong, what was said before the last step
// is soon out of date; 0.95 and 0.98 were neither better nor worse.
constexpr double kAgeingRight = 0.995;
constexpr double kAgeingWrong = 0.9;
// Of three degrees of freedom, 95 %. Right cameras took steps of up to 0.6 % of the light; true vignettes a first one
// of 8 to 20 %.
constexpr double kSignificantVignette = 7.8;
// Five standard deviations: what is not told of a shutter is far from what was taken for it, or right.
constexpr double kSignificantReadout = 25.0;
constexpr std::array<int, 4> kLenses{0, 1, 3, 5};  // parameters that are free: none, focal length, centre, distortion
constexpr int kVignette = CalibrationCorrection::kVignetteDim;
constexpr int kReadout = CalibrationCorrection::kReadout;

CalibrationCorrection::Vector priorSigma() {
  CalibrationCorrection::Vector sigma;
  sigma << 0.03, 0.02, 0.02, 0.05, 0.05, 0.015, 0.5, 0.5, 0.5;
  return sigma;
}

struct Step {
  CalibrationCorrection::Vector values;
  double decrease;  // of chi^2
};

/// The vignette is free, and of the rest these.
Step solveFor(CalibrationSystem system, int lens, bool readout) {
  for (int i = lens; i <= kReadout; ++i) {
    if (i == kReadout && readout) continue;
    system.H.row(i).setZero();
    system.H.col(i).setZero();
    system.H(i, i) = 1.0;
    system.b(i) = 0.0;
  }
  const CalibrationCorrection::Vector values = -system.H.ldlt().solve(system.b);
  return {values, -values.dot(system.b)};
}

}  // namespace

bool CalibrationEstimator::add(const CalibrationSystem& system) {
  const double ageing = lens_ == Lens::kDisproved ? kAgeingWrong : kAgeingRight;
  sum_.H = ageing * sum_.H + system.H / kCorrelation;
  sum_.b = ageing * sum_.b + system.b / kCorrelation;
  if (vignette_ == Vignette::kTold) {
    sum_.H.rightCols<kVignette>().setZero();
    sum_.H.bottomRows<kVignette>().setZero();
    sum_.b.tail<kVignette>().setZero();
  }
  ++windows_;
  ++steady_;
  const CalibrationCorrection::Vector before = correction_.values;
  if (correctVignette() || correctReadout() || (windows_ >= kLeastWindows && correctLens())) {
    sum_.b += sum_.H * (correction_.values - before);
    windows_ = 0;
    return true;
  }
  if (steady_ >= kSettledWindows) settled_ = correction_;
  return false;
}

bool CalibrationEstimator::isSettled() const { return windows_ >= kSettledWindows; }

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
  steady_ = 0;
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
  steady_ = 0;
  return true;
}

/// Of the simplest lens that the windows agree with, with the rest of the vignette and of the time of read-out: a
/// shutter is what it was taken for until its rows alone say otherwise. What is not needed stays as it was told.
bool CalibrationEstimator::correctLens() {
  const CalibrationSystem system = withPrior();
  const bool rolling = correction_.values(kReadout) != 0.0;
  const double nothing = solveFor(system, 0, false).decrease;
  std::array<Step, kLenses.size()> steps;
  for (std::size_t i = 0; i < steps.size(); ++i) steps[i] = solveFor(system, kLenses[i], rolling);
  std::size_t chosen = lens_ == Lens::kDisproved ? 1 : 0;
  for (std::size_t i = chosen + 1; i < steps.size(); ++i) {
    const double chance = kChance[static_cast<std::size_t>(kLenses[i] - kLenses[chosen])];
    const double least = i > 1 ? kBeyondFocalLength * chance : chance;
    if (steps[i].decrease - steps[chosen].decrease > least) chosen = i;
  }
  const auto free = static_cast<std::size_t>(kLenses[chosen] + (rolling ? 1 : 0));
  const double decrease = steps[chosen].decrease - nothing;
  if (!(decrease > (lens_ == Lens::kDisproved ? kWorthwhile : kChance[free]))) return false;
  correction_.values += steps[chosen].values;
  if (decrease > kChance[free]) steady_ = 0;
  if (kLenses[chosen] > 0) lens_ = Lens::kDisproved;
  return true;
}

}  // namespace mba_vo
