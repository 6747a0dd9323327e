#include "mba_vo/tracking/exposure_filter.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace mba_vo {
namespace {

constexpr double kSteady = 1e-3;  // noise of the acceleration [1/s^3]: 10 % in 3 s
// The same of an exposure that changes by a factor of 4 within 2.5 s, to and fro: its logarithm has an acceleration of
// up to 1.1 / s^2, which lasts for about a second.
constexpr double kVarying = 1.0;
constexpr double kRateSigma = 0.5;       // at first [1/s]
constexpr double kOutlier = 2.5;         // [standard deviations] from which on a sample counts for less
constexpr double kMemory = 0.95;         // of the surprise, from sample to sample
constexpr std::size_t kRemembered = 90;  // samples, for as long as keyframes stay in a window
constexpr double kLeastSigma = 0.05;     // of a sample: blur and motion are never known better

}  // namespace

ExposureFilter::ExposureFilter(double log_exposure, double sigma) {
  const Eigen::Vector2d state(log_exposure, 0.0);
  const Eigen::Matrix2d covariance = Eigen::Vector2d(sigma * sigma, kRateSigma * kRateSigma).asDiagonal();
  Eigen::Matrix2d steady = covariance;
  steady(1, 1) = 1e-6;
  filters_ = {Filter{kSteady, state, steady}, Filter{kVarying, state, covariance}};
}

Eigen::Matrix2d ExposureFilter::Filter::transition(double dt) const {
  const double straight = std::min(dt, kLongestExposureExtrapolation);
  Eigen::Matrix2d F;
  F << 1.0, straight, 0.0, straight < dt ? 0.0 : 1.0;
  return F;
}

void ExposureFilter::Filter::predict(double dt) {
  const Eigen::Matrix2d F = transition(dt);
  Eigen::Matrix2d Q;
  Q << dt * dt * dt / 3.0, dt * dt / 2.0, dt * dt / 2.0, dt;
  state = F * state;
  covariance = F * covariance * F.transpose() + acceleration * Q;
}

void ExposureFilter::Filter::update(double log_exposure, double sigma) {
  const double innovation = log_exposure - state(0);
  double variance = covariance(0, 0) + sigma * sigma;
  const double size = std::abs(innovation) / std::sqrt(variance);
  surprise = kMemory * surprise + std::min(size * size, kOutlier * kOutlier) + std::log(variance);
  if (size > kOutlier) variance *= size / kOutlier;  // as Huber's weight
  const Eigen::Vector2d gain = covariance.col(0) / variance;
  state += gain * innovation;
  covariance -= gain * covariance.row(0).eval();
}

void ExposureFilter::add(double time, double log_exposure, double sigma) {
  for (Filter& filter : filters_) {
    if (samples_ > 0) filter.predict(time - time_);
    filter.update(log_exposure, std::max(sigma, kLeastSigma));
  }
  time_ = time;
  ++samples_;
  past_.push_back({time, filters_});
  if (past_.size() > kRemembered) past_.pop_front();
}

std::vector<ExposureHistory::Entry> ExposureFilter::smoothed() const {
  std::vector<ExposureHistory::Entry> entries(past_.size());
  Eigen::Vector2d later;
  for (std::size_t i = past_.size(); i-- > 0;) {
    const Filter& filter = past_[i].filters[varies()];
    Eigen::Vector2d state = filter.state;
    if (i + 1 < past_.size()) {
      const double dt = past_[i + 1].time - past_[i].time;
      Filter predicted = filter;
      predicted.predict(dt);
      state += filter.covariance * filter.transition(dt).transpose() * predicted.covariance.inverse() *
               (later - predicted.state);
    }
    entries[i] = {past_[i].time, state(0), state(1)};
    later = state;
  }
  return entries;
}

ExposureFilter::Estimate ExposureFilter::at(double time) const {
  Filter filter = filters_[varies()];
  if (samples_ > 0 && time > time_) filter.predict(time - time_);
  return {filter.state(0), std::sqrt(filter.covariance(0, 0))};
}

}  // namespace mba_vo
