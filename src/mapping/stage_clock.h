#pragma once

#include <chrono>

namespace mba_vo {

using StageClock = std::chrono::steady_clock;

/// [ms]
inline double millisecondsSince(StageClock::time_point begin) {
  return std::chrono::duration<double, std::milli>(StageClock::now() - begin).count();
}

}  // namespace mba_vo
