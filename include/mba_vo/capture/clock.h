#pragma once

#include <cstdint>
#include <memory>

namespace mba_vo {

/// The two clocks of a machine, and waiting: a seam, so that tests need not wait.
class Clock {
 public:
  virtual ~Clock() = default;
  virtual std::int64_t wallNow() const = 0;       // CLOCK_REALTIME, which is ROS time [ns since 1970]
  virtual std::int64_t monotonicNow() const = 0;  // CLOCK_MONOTONIC, by which drivers stamp [ns]
  virtual void sleepFor(std::int64_t duration_ns) = 0;
};

std::shared_ptr<Clock> systemClock();

/// Wall clock minus monotonic clock [ns], now: the wall clock is set and corrected while the machine runs.
std::int64_t wallMinusMonotonic(const Clock& clock);

}  // namespace mba_vo
