#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

namespace mba_vo {

/// Looks at the exposures of the latest images, and says when they look as if another unit had been taken for seconds,
/// or as if they belonged to no image. Nothing is changed.
class ExposureWatch {
 public:
  static constexpr std::size_t kImages = 10;  // that have to agree

  /// `source`: who tells the exposures, for the text.
  explicit ExposureWatch(std::string source) : source_(std::move(source)) {}

  /// An image with its exposure [s], nullopt = unknown. `unmatched`: exposures come, but none with its stamp.
  void add(std::int64_t stamp_ns, std::optional<double> exposure, bool unmatched);
  /// Empty if all is well.
  std::string advice() const;

 private:
  struct Seen {
    std::int64_t stamp_ns;
    std::optional<double> exposure;
    bool unmatched;
  };
  std::string source_;
  std::deque<Seen> seen_;
};

}  // namespace mba_vo
