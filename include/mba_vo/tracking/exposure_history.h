#pragma once

#include <vector>

namespace mba_vo {

/// How far from a sample the rate of change of an exposure is believed [s].
inline constexpr double kLongestExposureExtrapolation = 0.3;

/// Exposures of the past as later images tell them, where nobody else does. Its log exposure has a value and a rate at
/// the times of its samples.
class ExposureHistory {
 public:
  struct Entry {
    double time;          // [s]
    double log_exposure;  // of the exposure over 1 s
    double rate;          // of the logarithm [1/s]
  };

  /// `entries`: in the order of time, at least one; std::invalid_argument without.
  explicit ExposureHistory(std::vector<Entry> entries);

  /// [s]; between two entries and, for as long as a rate is believed, beyond the first and the last.
  double exposureAt(double time) const;
  double newestTime() const { return entries_.back().time; }  // [s]

 private:
  std::vector<Entry> entries_;
};

}  // namespace mba_vo
