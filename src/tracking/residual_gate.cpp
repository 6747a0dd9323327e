#include "mba_vo/tracking/residual_gate.h"

#include <algorithm>
#include <vector>

#include "mba_vo/geometry/median.h"

namespace mba_vo {
namespace {

constexpr std::size_t kLeastImages = 20;
constexpr std::size_t kMostImages = 60;  // so that what lasts becomes usual
constexpr double kTimes = 3.0;           // the median; images of a right map stay below, but for a few
constexpr double kHarmless = 0.5;        // [px]

}  // namespace

void ResidualGate::add(double pixel_error) {
  errors_.push_back(pixel_error);
  if (errors_.size() > kMostImages) errors_.pop_front();
}

bool ResidualGate::isExceededBy(double pixel_error) const {
  if (errors_.size() < kLeastImages || pixel_error < kHarmless) return false;
  return pixel_error > kTimes * median(std::vector<double>(errors_.begin(), errors_.end()));
}

}  // namespace mba_vo
