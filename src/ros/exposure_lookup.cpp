#include "mba_vo/ros/exposure_lookup.h"

#include <cstdlib>
#include <iterator>

namespace mba_vo {

void ExposureLookup::add(std::int64_t stamp_ns, double exposure) {
  exposures_[stamp_ns] = exposure;
  if (exposures_.size() > kMaxEntries) {
    exposures_.erase(exposures_.begin());
  }
}

std::optional<double> ExposureLookup::find(std::int64_t stamp_ns) const {
  const auto begin = exposures_.lower_bound(stamp_ns - kToleranceNs);
  const auto end = exposures_.upper_bound(stamp_ns + kToleranceNs);
  auto best = end;
  for (auto it = begin; it != end; ++it) {
    if (best == end || std::llabs(it->first - stamp_ns) < std::llabs(best->first - stamp_ns)) {
      best = it;
    }
  }
  return best == end ? std::nullopt : std::make_optional(best->second);
}

bool ExposureLookup::hasLater(std::int64_t stamp_ns) const {
  return !exposures_.empty() && exposures_.rbegin()->first > stamp_ns + kToleranceNs;
}

void ExposureLookup::forgetBefore(std::int64_t stamp_ns) {
  exposures_.erase(exposures_.begin(), exposures_.lower_bound(stamp_ns));
}

}  // namespace mba_vo
