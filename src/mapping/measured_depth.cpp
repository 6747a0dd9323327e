#include "mba_vo/mapping/measured_depth.h"

#include <algorithm>
#include <cmath>

#include "mba_vo/mapping/schur_complement.h"
#include "mba_vo/mapping/window_state.h"

namespace mba_vo {
namespace {

constexpr int kRadius = 2;            // of the surroundings [px]
constexpr double kEdge = 0.07;        // difference of inverse depths in the surroundings, relative, that is an edge ...
constexpr double kNoiseSigmas = 6.0;  // ... beyond this noise
constexpr double kCauchySigmas = 3.0;  // deviation from which on a measurement loses its influence

// Of the residuals, correlation included [grey levels^2]. Not as they are: wrong depths make them large, and would win
// by that.
constexpr double kImageVariance = 25.0;

constexpr double kAgreeSigmas = 3.0;  // within which two measurements agree
constexpr int kMinCompared = 30;      // points that mean something
constexpr double kMinAgreeing = 0.8;  // share of them

constexpr double kTellingSigma = 0.1;  // of an inverse depth by the images, relative, that tells something

}  // namespace

MeasuredDepth measureDepth(const cv::Mat1f& depth, const Eigen::Vector2i& pixel, const DepthSensorConfig& config) {
  const cv::Rect inside(kRadius, kRadius, depth.cols - 2 * kRadius, depth.rows - 2 * kRadius);
  if (!inside.contains({pixel.x(), pixel.y()})) return {};
  float nearest = std::numeric_limits<float>::max();
  float farthest = 0.0F;
  for (int y = pixel.y() - kRadius; y <= pixel.y() + kRadius; ++y) {
    for (int x = pixel.x() - kRadius; x <= pixel.x() + kRadius; ++x) {
      const float z = depth(y, x);
      if (!(z > 0.0F)) return {};  // NaN too
      nearest = std::min(nearest, z);
      farthest = std::max(farthest, z);
    }
  }
  if (farthest > config.max_depth) return {};
  const auto inverse = [&](int dx, int dy) { return 1.0 / static_cast<double>(depth(pixel.y() + dy, pixel.x() + dx)); };
  const double w = inverse(0, 0);
  const double noise = std::hypot(config.inverse_depth_sigma, config.relative_sigma * w);
  const double spread = 1.0 / static_cast<double>(nearest) - 1.0 / static_cast<double>(farthest);
  if (spread > kEdge * w + kNoiseSigmas * noise) return {};
  const Eigen::Vector2d slope(inverse(kRadius, 0) - inverse(-kRadius, 0), inverse(0, kRadius) - inverse(0, -kRadius));
  const double shift = config.registration_sigma * slope.norm() / (2.0 * kRadius);
  return {w, noise * noise + shift * shift};
}

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
