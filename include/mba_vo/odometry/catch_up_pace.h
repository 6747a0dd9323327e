#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

namespace mba_vo {

/// Sees to it that catching up comes to an end, however slow the machine is. Time is that of the images that come in
/// meanwhile: where they wait for nobody, as offline, none passes and nothing is left out.
class CatchUpPace {
 public:
  /// Of the frames that wait, the newest of which is of `newest_ns`: how many of the oldest are to be left out before
  /// the next one is tracked.
  std::size_t framesToLeaveOut(std::size_t waiting, std::int64_t newest_ns);
  /// Images have come in since it began: there is no time for anything else.
  bool isPressed() const { return begin_ns_ && newest_ns_ > *begin_ns_; }
  /// Nothing waits any more.
  void reset() { begin_ns_.reset(); }

 private:
  std::optional<std::int64_t> begin_ns_;  // of the newest frame when it began
  std::int64_t newest_ns_ = 0;            // of the newest by now
  std::size_t tracked_ = 0;               // since then
};

}  // namespace mba_vo
