#include "mba_vo/window/depth_agreement.h"

#include <cmath>

#include "mba_vo/solver/schur_complement.h"
#include "mba_vo/window/window_state.h"

namespace mba_vo {
namespace {

constexpr double kCauchySigmas = 3.0;  // deviation from which on a measurement loses its influence

// Of the residuals, correlation included [grey levels^2]. Not as they are: wrong depths make them large, and would win
// by that.
constexpr double kImageVariance = 25.0;

constexpr double kAgreeSigmas = 3.0;  // within which two measurements agree
constexpr int kMinCompared = 30;      // points that mean something
constexpr double kMinAgreeing = 0.8;  // share of them

constexpr double kTellingSigma = 0.1;  // of an inverse depth by the images, relative, that tells something

}  // namespace

MeasuredDepthTerm measuredDepthTerm(const MeasuredDepth& measured, double inverse_depth, double precision) {
  if (!measured.known()) return {};
  const double information = precision * kImageVariance / measured.variance;
  const double deviation = inverse_depth - measured.inverse_depth;
  const double scale = kCauchySigmas * kCauchySigmas * measured.variance;
  const double excess = deviation * deviation / scale;
  const double weight = 1.0 / (1.0 + excess);
  return {information * scale * std::log1p(excess), information * weight, information * weight * deviation};
}

double measuredDepthCost(const WindowState& state) {
  const double precision = state.meanPrecision();
  double cost = 0.0;
  for (const PointState& point : state.points) {
    cost += measuredDepthTerm(point.measured, point.inverse_depth, precision).cost;
  }
  return cost;
}

bool DepthAgreement::fails() const {
  return compared >= kMinCompared && agreeing < kMinAgreeing * static_cast<double>(compared);
}

DepthAgreement compareDepths(const WindowState& state) {
  const double precision = state.meanPrecision();
  DepthAgreement result;
  for (const PointState& point : state.points) {
    if (!point.measured.known() || state.goodResiduals(point) == 0) continue;
    // By the images alone: what the measurement adds is known.
    const MeasuredDepthTerm term = measuredDepthTerm(point.measured, point.inverse_depth, precision);
    const double information = (point.information - term.H) / (precision * kImageVariance);
    const double telling = kTellingSigma * point.measured.inverse_depth;
    if (information * telling * telling < 1.0) continue;
    const double by_images = point.inverse_depth + term.b / (precision * kImageVariance * information);
    const double sigma = std::sqrt(point.measured.variance + 1.0 / information);
    ++result.compared;
    if (std::abs(by_images - point.measured.inverse_depth) < kAgreeSigmas * sigma) ++result.agreeing;
  }
  return result;
}

void addMeasuredDepth(const PointState& point, double precision, Eigen::Index row, LinearizedWindow& system) {
  const MeasuredDepthTerm term = measuredDepthTerm(point.measured, point.inverse_depth, precision);
  system.H_depth(row) += term.H;
  system.b_depth(row) += term.b;
}

}  // namespace mba_vo
