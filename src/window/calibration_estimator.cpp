#include "mba_vo/window/calibration_estimator.h"

#include <Eigen/Cholesky>

namespace mba_vo {
namespace {

constexpr int kLeastWindows = 4;
// Pixels of a patch, patches of a point, and windows that share keyframes are far from independent; and what no model
// explains is the same in many residuals. The scatter of the windows' estimates is some ten times what the residuals
// alone would have.
constexpr double kCorrelation = 50.0;
// Of six degrees of freedom, 95 %. Right calibrations stayed below 5 (docs/how_it_works.md); where 50 was waited for,
// the scale of kitchen had drifted by a fifth before a first step was taken.
constexpr double kSignificant = 12.6;  // chi^2 of a step worth taking
constexpr double kStep = 1.5;

CalibrationCorrection::Vector priorSigma() {
  CalibrationCorrection::Vector sigma;
  sigma << 0.03, 0.02, 0.02, 0.05, 0.05, 3e-5;
  return sigma;
}

}  // namespace

bool CalibrationEstimator::add(const CalibrationSystem& system) {
  sum_.H += system.H / kCorrelation;
  sum_.b += system.b / kCorrelation;
  if (++windows_ < kLeastWindows) return false;
  const CalibrationCorrection::Vector prior = priorSigma().array().square().inverse();
  CalibrationCorrection::Matrix H = sum_.H;
  H.diagonal() += prior;
  const CalibrationCorrection::Vector b = sum_.b + prior.cwiseProduct(correction_.values);
  const CalibrationCorrection::Vector step = -H.ldlt().solve(b);
  if (!(step.dot(H * step) > kSignificant)) return false;
  correction_.values += kStep * step;
  sum_ = {};
  windows_ = 0;
  return true;
}

}  // namespace mba_vo
