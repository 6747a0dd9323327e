#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "mba_vo/image/parallel_for.h"

namespace mba_vo {

/// Points cut in chunks whose bounds depend only on their number: sums over a chunk that are added in order do not
/// depend on the threads used.
class PointChunks {
 public:
  explicit PointChunks(std::size_t points)
      : points_(points), size_(std::max(kLeastPoints, (points + kMost - 1) / kMost)) {}

  std::size_t count() const { return (points_ + size_ - 1) / size_; }
  /// Calls body(chunk, row) for all rows, those of different chunks on different threads.
  template <typename Body>
  void forEachRow(const Body& body) const {
    parallelFor(count(), [&](std::size_t chunk) {
      const std::size_t end = std::min((chunk + 1) * size_, points_);
      for (std::size_t row = chunk * size_; row < end; ++row) body(chunk, row);
    });
  }

 private:
  static constexpr std::size_t kMost = 16;
  static constexpr std::size_t kLeastPoints = 64;  // of a chunk
  std::size_t points_;
  std::size_t size_;
};

/// Sums of a chunk for each pair of keyframes that its points have residuals in: few, for points come by host.
template <typename Sums>
class PairSumsOfChunk {
 public:
  explicit PairSumsOfChunk(std::size_t pairs) : slot_(pairs, kNone) {}
  Sums& at(std::size_t pair) {
    if (slot_[pair] == kNone) {
      slot_[pair] = static_cast<int>(sums_.size());
      sums_.emplace_back();
    }
    return sums_[static_cast<std::size_t>(slot_[pair])];
  }
  void addTo(std::size_t pair, Sums& total) const {
    if (slot_[pair] != kNone) total += sums_[static_cast<std::size_t>(slot_[pair])];
  }

 private:
  static constexpr int kNone = -1;
  std::vector<int> slot_;  // by host * keyframes + target
  std::vector<Sums> sums_;
};

}  // namespace mba_vo
