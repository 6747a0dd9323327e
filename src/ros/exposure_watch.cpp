#include "mba_vo/ros/exposure_watch.h"

#include <algorithm>
#include <vector>

#include "mba_vo/geometry/median.h"
#include "mba_vo/io/exposure_advice.h"

namespace mba_vo {

void ExposureWatch::add(std::int64_t stamp_ns, std::optional<double> exposure, bool unmatched) {
  if (!seen_.empty() && stamp_ns <= seen_.back().stamp_ns) seen_.clear();  // another recording
  seen_.push_back({stamp_ns, exposure, unmatched});
  if (seen_.size() > kImages) seen_.pop_front();
}

std::string ExposureWatch::advice() const {
  if (seen_.size() < kImages) return "";
  if (std::all_of(seen_.begin(), seen_.end(), [](const Seen& seen) { return seen.unmatched; })) {
    return "exposures come on " + source_ + ", but none has the stamp of an image: exposure_relay can match them";
  }
  std::vector<double> exposures, intervals;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    if (seen_[i].exposure) exposures.push_back(*seen_[i].exposure);
    if (i > 0) intervals.push_back(1e-9 * static_cast<double>(seen_[i].stamp_ns - seen_[i - 1].stamp_ns));
  }
  if (2 * exposures.size() < seen_.size()) return "";
  return exposureAdvice("the exposure told by " + source_, median(exposures), median(intervals));
}

}  // namespace mba_vo
