#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

namespace mba_vo {

/// Whether there is time to track frames once more while new images come, each of which then waits behind them. What
/// counts are frames that wait, not times: where none waits, as offline, there is always time.
class RevisionPace {
 public:
  /// Frames are to be tracked once more.
  void begin() { least_ = kMany, images_ = 0; }
  /// With each image meanwhile, so many frames wait: true if they do not become fewer. To be left then.
  bool isTooSlow(std::size_t waiting, std::int64_t image_ns);
  /// It was too slow a short time ago: another try would only delay the new images.
  bool rests(std::int64_t image_ns) const { return image_ns < rests_until_ns_; }
  void reset() { *this = {}; }

 private:
  static constexpr std::size_t kMany = std::numeric_limits<std::size_t>::max();

  std::size_t least_ = kMany;  // that have waited
  int images_ = 0;             // since then
  std::int64_t rests_until_ns_ = std::numeric_limits<std::int64_t>::min();
};

}  // namespace mba_vo
