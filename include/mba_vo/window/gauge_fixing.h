#pragma once

#include <vector>

#include "mba_vo/window/window_state.h"

namespace mba_vo {

/// Images tell neither where a window is as a whole, nor, without measured depths, how large: the gauge. What holds it
/// is the marginalisation prior, more weakly with every keyframe that leaves, so that an optimisation may move or
/// rescale the window by much more than its keyframes move against each other. This keeps it where it was before.
class GaugeFixing {
 public:
  /// Remembers where all but the newest keyframe are, and how large the window is, if it may be of any size.
  explicit GaugeFixing(const WindowState& state);

  /// Moves the whole window so that these keyframes have, in the mean, not moved. For a state with the same keyframes.
  void restore(WindowState& state) const;

 private:
  struct Point {
    PointId id;
    double inverse_depth;
  };

  double scaleOf(const WindowState& state) const;

  bool any_scale_;
  std::vector<SE3> T_map_keyframe_;
  std::vector<Point> points_;  // by id
};

}  // namespace mba_vo
