#pragma once

#include <cstddef>
#include <limits>
#include <vector>

namespace mba_vo {

/// A figure that does not exist.
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Summary of a list of errors; NaN where there is no value. Median and percentile interpolate linearly between ranks.
struct Statistics {
  std::size_t count = 0;
  double rmse = 0.0;
  double mean = 0.0;
  double median = 0.0;
  double percentile_90 = 0.0;
  double max = 0.0;
};

/// Value with `fraction` [0, 1] of the values below it, of at least one value, sorted; linear between ranks.
double quantile(const std::vector<double>& sorted, double fraction);

Statistics summarize(std::vector<double> values);

}  // namespace mba_vo
