#pragma once

#include <cmath>

namespace mba_vo {

/// Huber loss: quadratic up to `threshold`, linear beyond.
class HuberLoss {
 public:
  explicit HuberLoss(double threshold) : threshold_(threshold) {}

  /// rho(r), equal to r^2 / 2 for small residuals.
  double cost(double residual) const {
    const double r = std::abs(residual);
    return r <= threshold_ ? 0.5 * r * r : threshold_ * (r - 0.5 * threshold_);
  }

  /// rho'(r) / r, the weight of iteratively re-weighted least squares.
  double weight(double residual) const {
    const double r = std::abs(residual);
    return r <= threshold_ ? 1.0 : threshold_ / r;
  }

  double threshold() const { return threshold_; }

 private:
  double threshold_;
};

}  // namespace mba_vo
