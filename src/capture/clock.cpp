#include "mba_vo/capture/clock.h"

#include <chrono>
#include <limits>
#include <thread>

namespace mba_vo {
namespace {

template <typename ChronoClock>
std::int64_t nanoseconds() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(ChronoClock::now().time_since_epoch()).count();
}

/// On Linux these two are CLOCK_REALTIME and CLOCK_MONOTONIC.
class SystemClock : public Clock {
 public:
  std::int64_t wallNow() const override { return nanoseconds<std::chrono::system_clock>(); }
  std::int64_t monotonicNow() const override { return nanoseconds<std::chrono::steady_clock>(); }
  void sleepFor(std::int64_t duration_ns) override {
    std::this_thread::sleep_for(std::chrono::nanoseconds(duration_ns));
  }
};

}  // namespace

std::shared_ptr<Clock> systemClock() { return std::make_shared<SystemClock>(); }

std::int64_t wallMinusMonotonic(const Clock& clock) {
  // Another process may run between two readings: of a few tries the one that took least time.
  constexpr int kTries = 3;
  std::int64_t best = 0;
  std::int64_t shortest = std::numeric_limits<std::int64_t>::max();
  for (int i = 0; i < kTries; ++i) {
    const std::int64_t before = clock.monotonicNow();
    const std::int64_t wall = clock.wallNow();
    const std::int64_t after = clock.monotonicNow();
    if (after - before < shortest) {
      shortest = after - before;
      best = wall - (before + (after - before) / 2);
    }
  }
  return best;
}

}  // namespace mba_vo
