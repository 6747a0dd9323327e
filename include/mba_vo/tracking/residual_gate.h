#pragma once

#include <cstddef>
#include <deque>

namespace mba_vo {

/// Knows how well images have lately fitted the map, and tells those that fit much worse: what an image shows there is
/// not what the map says, though it may still look good enough by itself.
class ResidualGate {
 public:
  /// `pixel_error`: as TrackedFrame::pixel_error.
  void add(double pixel_error);
  /// False as long as too few images are known.
  bool isExceededBy(double pixel_error) const;
  void reset() { errors_.clear(); }

 private:
  std::deque<double> errors_;  // of the last images [px]
};

}  // namespace mba_vo
