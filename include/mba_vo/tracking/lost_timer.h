#pragma once

#include <cstdint>
#include <optional>

namespace mba_vo {

/// For how long frames have been lost that could have been found. Tracker and mapper both keep one, and agree.
class LostTimer {
 public:
  /// `blind`: the image shows nothing, so that its time does not count.
  void lose(std::int64_t mid_exposure_ns, bool blind) {
    if (last_ns_ && mid_exposure_ns <= *last_ns_) return;  // tracked again, and lost again
    if (last_ns_ && !blind) seconds_ += 1e-9 * static_cast<double>(mid_exposure_ns - *last_ns_);
    last_ns_ = mid_exposure_ns;
  }
  void find() {
    last_ns_.reset();
    seconds_ = 0.0;
  }
  bool lost() const { return last_ns_.has_value(); }
  double seconds() const { return seconds_; }

 private:
  std::optional<std::int64_t> last_ns_;
  double seconds_ = 0.0;
};

}  // namespace mba_vo
