#include "mba_vo/tracking/exposure_history.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace mba_vo {
namespace {

double beyond(const ExposureHistory::Entry& entry, double time) {
  return entry.log_exposure +
         entry.rate * std::clamp(time - entry.time, -kLongestExposureExtrapolation, kLongestExposureExtrapolation);
}

}  // namespace

ExposureHistory::ExposureHistory(std::vector<Entry> entries) : entries_(std::move(entries)) {
  if (entries_.empty()) throw std::invalid_argument("exposure history: it has no entries, must have at least one");
}

double ExposureHistory::exposureAt(double time) const {
  const auto after = std::lower_bound(entries_.begin(), entries_.end(), time,
                                      [](const Entry& entry, double t) { return entry.time < t; });
  if (after == entries_.begin()) return std::exp(beyond(entries_.front(), time));
  if (after == entries_.end()) return std::exp(beyond(entries_.back(), time));
  const Entry& before = *(after - 1);
  const double share = (time - before.time) / (after->time - before.time);
  return std::exp((1.0 - share) * before.log_exposure + share * after->log_exposure);
}

}  // namespace mba_vo
