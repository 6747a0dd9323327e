#include "mba_vo/io/calibration_estimate.h"

#include <algorithm>

#include <Eigen/Cholesky>

namespace mba_vo {
namespace {

using Correction = CalibrationCorrection;

// Residuals are far from independent; the estimator of window/ weighs them with a fiftieth of their number, too, and
// has the same prior.
constexpr double kCorrelation = 50.0;
// Under a rolling shutter, what is wrong with the velocities of keyframes goes the same way in many windows. On six
// rendered sequences (hand_desk, head_room6, drone_v202) the six numbers of the geometry were 3.6 times as far off.
constexpr double kRolling = 3.6;
constexpr int kParts = 6;         // of the run, for the scatter: long beside the windows that share keyframes
constexpr int kLeastWindows = 3;  // in each

Correction::Vector priorSigma() {
  Correction::Vector sigma;
  sigma << 0.03, 0.02, 0.02, 0.05, 0.05, 3e-5, 0.5, 0.5, 0.5;
  return sigma;
}

struct Sums {
  CalibrationSystem system;  // of the whole correction: its b is that at a correction of zero
  int windows = 0;

  void add(const Sums& other) {
    system.H += other.system.H;
    system.b += other.system.b;
    windows += other.windows;
  }
};

Sums sumsOf(const KeyframeReport& keyframe, bool vignette_told) {
  if (!keyframe.calibration) return {};
  Sums sums{keyframe.calibration->system, 1};
  sums.system.H /= kCorrelation;
  sums.system.b /= kCorrelation;
  // What is left by the correction that the images had then.
  sums.system.b -= sums.system.H * keyframe.calibration->correction.values;
  if (vignette_told) {
    sums.system.H.rightCols<Correction::kVignetteDim>().setZero();
    sums.system.H.bottomRows<Correction::kVignetteDim>().setZero();
    sums.system.b.tail<Correction::kVignetteDim>().setZero();
  }
  return sums;
}

CalibrationEstimate solve(const Sums& sums) {
  Correction::Matrix H = sums.system.H;
  H.diagonal() += priorSigma().array().square().inverse().matrix();
  CalibrationEstimate estimate;
  estimate.covariance = H.ldlt().solve(Correction::Matrix::Identity());
  estimate.correction.values = -estimate.covariance * sums.system.b;
  estimate.windows = sums.windows;
  return estimate;
}

/// By how much each number's estimates without one part of the run scatter: the jackknife.
Correction::Vector scatterOf(const std::vector<Sums>& parts) {
  const auto count = static_cast<double>(parts.size());
  Correction::Vector sum = Correction::Vector::Zero();
  Correction::Vector squares = Correction::Vector::Zero();
  for (std::size_t left_out = 0; left_out < parts.size(); ++left_out) {
    Sums rest;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (i != left_out) rest.add(parts[i]);
    }
    const Correction::Vector x = solve(rest).correction.values;
    sum += x;
    squares += x.cwiseAbs2();
  }
  const Correction::Vector mean = sum / count;
  return ((count - 1.0) * (squares / count - mean.cwiseAbs2())).cwiseMax(0.0).cwiseSqrt();
}

}  // namespace

double CalibrationEstimate::chi2(const CalibrationCorrection& other) const {
  const Correction::Vector d = correction.values - other.values;
  return d.dot(covariance.ldlt().solve(d));
}

CalibrationEstimate estimateCalibration(const std::vector<KeyframeReport>& keyframes, std::size_t count,
                                        const CameraKind& camera) {
  std::vector<Sums> windows;
  for (std::size_t i = 0; i < std::min(count, keyframes.size()); ++i) {
    const Sums sums = sumsOf(keyframes[i], camera.vignette_told);
    if (sums.windows > 0) windows.push_back(sums);
  }
  Sums total;
  std::vector<Sums> parts(kParts);
  for (std::size_t i = 0; i < windows.size(); ++i) {
    total.add(windows[i]);
    parts[i * kParts / windows.size()].add(windows[i]);
  }
  CalibrationEstimate estimate = solve(total);
  if (camera.rolling) estimate.covariance *= kRolling * kRolling;
  if (total.windows < kParts * kLeastWindows) return estimate;
  const Correction::Vector larger =
      scatterOf(parts).cwiseQuotient(estimate.sigma()).cwiseMax(Correction::Vector::Ones());
  estimate.covariance = larger.asDiagonal() * estimate.covariance * larger.asDiagonal();
  return estimate;
}

}  // namespace mba_vo
