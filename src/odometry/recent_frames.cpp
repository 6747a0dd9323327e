#include "mba_vo/odometry/recent_frames.h"

#include <algorithm>

namespace mba_vo {
namespace {

constexpr double kLongestMemory = 1.0;  // [s]

}  // namespace

void RecentFrames::add(const Entry& entry, bool badly_seen) {
  if (entries_.empty() && !badly_seen) return;
  entries_.push_back(entry);
  const std::int64_t newest_ns = entry.frame->mid_exposure_ns;
  const auto tooOld = [&](const Entry& e) {
    return 1e-9 * static_cast<double>(newest_ns - e.frame->mid_exposure_ns) > kLongestMemory;
  };
  while (tooOld(entries_.front())) entries_.pop_front();
}

void RecentFrames::changeReference(const SE3& T_new_old) {
  for (Entry& entry : entries_) entry.before.changeReference(T_new_old);
}

std::vector<RecentFrames::Entry> RecentFrames::takeAfter(std::int64_t mid_exposure_ns) {
  const auto isLater = [&](const Entry& e) { return e.frame->mid_exposure_ns > mid_exposure_ns; };
  std::vector<Entry> later(std::find_if(entries_.begin(), entries_.end(), isLater), entries_.end());
  entries_.clear();
  return later;
}

}  // namespace mba_vo
