#include "mba_vo/solver/residual_spread.h"

#include <algorithm>
#include <cstddef>

namespace mba_vo {
namespace {

constexpr double kSigmaOfMedian = 1.4826;  // standard deviation over median size of a normal distribution
constexpr double kClearlyOff = 2.5;        // [standard deviations]
constexpr double kLeast = 0.6;             // [grey levels] what the noise of two images differs by, standard deviation

}  // namespace

double residualSpread(std::vector<float>& sizes) {
  if (sizes.empty()) return 0.0;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return kSigmaOfMedian * static_cast<double>(*middle);
}

double huberThreshold(double spread, double largest) {
  return std::min(kClearlyOff * std::max(spread, kLeast), largest);
}

double residualPrecision(double spread) {
  const double sigma = std::max(spread, kLeast);
  return 1.0 / (sigma * sigma);
}

}  // namespace mba_vo
