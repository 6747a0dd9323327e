#include "mba_vo/evaluation/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mba_vo {

double quantile(const std::vector<double>& sorted, double fraction) {
  const double rank = fraction * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(rank);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  const double weight = rank - static_cast<double>(below);
  return (1.0 - weight) * sorted[below] + weight * sorted[above];
}

Statistics summarize(std::vector<double> values) {
  if (values.empty()) {
    return {0, kNone, kNone, kNone, kNone, kNone};
  }
  std::sort(values.begin(), values.end());
  double sum = 0.0;
  double sum_of_squares = 0.0;
  for (const double value : values) {
    sum += value;
    sum_of_squares += value * value;
  }
  const auto n = static_cast<double>(values.size());
  return {values.size(),         std::sqrt(sum_of_squares / n), sum / n,
          quantile(values, 0.5), quantile(values, 0.9),         values.back()};
}

}  // namespace mba_vo
