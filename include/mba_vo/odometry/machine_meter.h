#pragma once

#include <cstddef>

#include "mba_vo/odometry/machine.h"

namespace mba_vo {

/// Measures how long the steps of the pipeline take, for the table of a Machine. Run on one core (taskset), it measures
/// one-core times.
class MachineMeter {
 public:
  void add(const TrackerStep& step, double seconds);
  void add(const MapperStep& step, double seconds);

  /// What has been measured; the rest is as in `otherwise`.
  Machine machine(const Machine& otherwise = Machine()) const;

 private:
  /// Mean, and line of least squares over a quantity x that the time depends on.
  class Fit {
   public:
    void add(double ms, double x = 0.0);
    bool empty() const { return count_ == 0; }
    double mean() const;    // [ms]
    double slope() const;   // [ms] for each unit of x, not negative
    double offset() const;  // [ms] at x = 0, not negative
    double at(double x) const { return offset() + slope() * x; }

   private:
    std::size_t count_ = 0;
    double t_ = 0.0, x_ = 0.0, xx_ = 0.0, xt_ = 0.0;  // sums
  };

  void addFrame(const MapperStep& step, double ms);

  Fit image_, track_, orientation_, look_for_map_, first_map_, depth_search_, draft_, iteration_, keyframe_,
      relocalize_, deferred_;
};

}  // namespace mba_vo
