#include "mba_vo/odometry/catch_up_leap.h"

#include <algorithm>

namespace mba_vo {
namespace {

// docs/decisions/2026-11-27-leaping.md
constexpr std::size_t kMany = 10;  // frames wait when it begins: a third of a second at 30 Hz
constexpr double kPatience = 0.1;  // [s] a machine that keeps up has caught up by then, without a leap

}  // namespace

std::size_t CatchUpLeap::over(std::size_t waiting, std::int64_t newest_ns) {
  if (!begin_ns_) {
    begin_ns_ = newest_ns;
    hurried_ = hurried_ || waiting > kMany;
  }
  const double elapsed = 1e-9 * static_cast<double>(newest_ns - *begin_ns_);  // [s]
  pressed_ = hurried_ || elapsed > 0.0;
  return hurried_ || elapsed >= kPatience ? std::min(waiting - 1, furthest_) : 0;
}

void CatchUpLeap::reach(std::size_t frames) {
  if (furthest_ != kAnywhere) furthest_ = 2 * frames + 1;
  lost_ = 0;
}

}  // namespace mba_vo
