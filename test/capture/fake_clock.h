#pragma once

#include "mba_vo/capture/clock.h"

namespace mba_vo {

/// Time passes only while somebody waits.
class FakeClock : public Clock {
 public:
  std::int64_t wallNow() const override { return now_ + offset_; }
  std::int64_t monotonicNow() const override { return now_; }
  void sleepFor(std::int64_t duration_ns) override { now_ += duration_ns; }

  /// Somebody sets the wall clock.
  void setWallMinusMonotonic(std::int64_t offset_ns) { offset_ = offset_ns; }

 private:
  std::int64_t now_ = 1'000'000'000'000;  // the machine has been running for a while
  std::int64_t offset_ = 1'700'000'000'000'000'000;
};

}  // namespace mba_vo
