#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

namespace mba_vo {

/// What to do with an input image.
struct InputVerdict {
  bool accepted = true;
  std::string reason;              // why rejected, or what is wrong with the exposure; empty if all is well
  std::optional<double> exposure;  // to use [s]; nullopt = unknown
  /// The stamp went back so far that a clock or a recording must have started anew: the caller may reset() and go on.
  bool clock_restarted = false;
};

/// Checks stamps and exposure times at the input. Stamps must increase. An exposure that is negative, not a number or
/// longer than the frames are apart is treated as unknown, for the image is still good.
class InputGuard {
 public:
  /// Only accepted images are remembered.
  InputVerdict check(std::int64_t stamp_ns, std::optional<double> exposure);

  /// Forgets the stamps seen so far.
  void reset();

 private:
  std::string problemOfExposure(double exposure) const;

  std::optional<std::int64_t> last_stamp_ns_;
  std::deque<double> intervals_;  // between the latest accepted stamps [s]
};

}  // namespace mba_vo
