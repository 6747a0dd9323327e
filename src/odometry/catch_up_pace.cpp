#include "mba_vo/odometry/catch_up_pace.h"

#include <algorithm>
#include <cmath>

namespace mba_vo {
namespace {

// Chosen by simulated live runs (mba_vo_offline --live) of desk from image 20, shake from 10 and 20, kitchen from 0.
constexpr double kLeastTime = 0.1;       // [s] until the pace is known: three images at 30 Hz
constexpr double kLongestCatchUp = 2.0;  // [s] after which no frame shall wait
constexpr double kMostLeftOut = 2.0;  // frames for each one that is tracked: with more, maps are lost on shaken starts

}  // namespace

std::size_t CatchUpPace::framesToLeaveOut(std::size_t waiting, std::int64_t newest_ns) {
  if (!begin_ns_) {
    begin_ns_ = newest_ns;
    tracked_ = 0;
  }
  newest_ns_ = newest_ns;
  const double elapsed = 1e-9 * static_cast<double>(newest_ns - *begin_ns_);  // [s]
  const std::size_t tracked = tracked_++;
  if (elapsed < kLeastTime) return 0;
  const double can_be_tracked = static_cast<double>(tracked) / elapsed * std::max(0.0, kLongestCatchUp - elapsed);
  const double stride = std::ceil(static_cast<double>(waiting) / std::max(1.0, can_be_tracked));
  return static_cast<std::size_t>(elapsed < kLongestCatchUp ? std::min(stride - 1.0, kMostLeftOut) : stride - 1.0);
}

}  // namespace mba_vo
