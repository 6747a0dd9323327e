#pragma once

#include <array>
#include <deque>
#include <vector>

#include <Eigen/Core>

#include "mba_vo/tracking/exposure_history.h"

namespace mba_vo {

/// Follows the logarithm of an exposure that may change from image to image, as automatic exposure changes it. Two
/// Kalman filters of value and rate, one for exposures that stay as they are and one for those that change fast; the
/// one that has predicted the last samples better speaks.
class ExposureFilter {
 public:
  struct Estimate {
    double log_exposure = 0.0;
    double sigma = 0.0;
  };

  /// `log_exposure`, `sigma`: what is known before.
  ExposureFilter(double log_exposure, double sigma);

  /// Samples should come in the order of time [s].
  void add(double time, double log_exposure, double sigma);
  Estimate at(double time) const;
  int samples() const { return samples_; }
  /// What all samples together say of the times of the last ones (Rauch, Tung and Striebel's smoother).
  std::vector<ExposureHistory::Entry> smoothed() const;
  /// True if the exposures seem to change.
  bool varies() const { return filters_[1].surprise < filters_[0].surprise; }

 private:
  struct Filter {
    double acceleration;  // white noise, density [1/s^3]
    Eigen::Vector2d state;
    Eigen::Matrix2d covariance;
    double surprise = 0.0;  // -2 log likelihood of the last samples, fading

    Eigen::Matrix2d transition(double dt) const;
    void predict(double dt);
    void update(double log_exposure, double sigma);
  };

  struct Posterior {
    double time;  // of a sample [s]
    std::array<Filter, 2> filters;
  };

  std::array<Filter, 2> filters_;
  std::deque<Posterior> past_;  // after each of the last samples
  double time_ = 0.0;           // of the last sample [s]
  int samples_ = 0;
};

}  // namespace mba_vo
