#pragma once

#include <algorithm>

namespace mba_vo {

/// How many points the window is to hold: as many as are configured, and fewer where keyframes come faster than it can
/// be optimised. Keyframes in a row that are not optimised at all let the map slide, a window with half the points
/// hardly (docs/decisions/2026-11-29-point-budget.md). Falls and rises as the rate of a sender in a full network does.
class PointBudget {
 public:
  explicit PointBudget(int most) : most_(most) {}

  int points() const { return static_cast<int>(share_ * most_); }
  /// The next keyframe came before the window was optimised once.
  void fallBehind() { share_ = std::max(kLeastShare, kFall * share_); }
  /// It was optimised to the end.
  void keepUp() { share_ = std::min(1.0, kRise * share_); }

 private:
  static constexpr double kFall = 0.7;
  static constexpr double kRise = 1.03;
  static constexpr double kLeastShare = 0.4;
  int most_;
  double share_ = 1.0;
};

}  // namespace mba_vo
