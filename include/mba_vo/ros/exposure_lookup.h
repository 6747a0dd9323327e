#pragma once

#include <cstdint>
#include <map>
#include <optional>

namespace mba_vo {

/// Exposure times by the stamp of the image they belong to.
class ExposureLookup {
 public:
  /// Stamps closer than this are one stamp: drivers that convert through floating-point seconds lose the last digits.
  static constexpr std::int64_t kToleranceNs = 500'000;
  static constexpr std::size_t kMaxEntries = 100'000;

  /// `exposure` [s]; NaN = known to be unknown.
  void add(std::int64_t stamp_ns, double exposure);
  /// Exposure message for the image with this stamp [s, maybe NaN]; nullopt if none came.
  std::optional<double> find(std::int64_t stamp_ns) const;
  /// True if a message for a later image has come, so one for this image is no longer expected.
  bool hasLater(std::int64_t stamp_ns) const;
  void forgetBefore(std::int64_t stamp_ns);
  void clear() { exposures_.clear(); }
  std::size_t size() const { return exposures_.size(); }

 private:
  std::map<std::int64_t, double> exposures_;
};

}  // namespace mba_vo
