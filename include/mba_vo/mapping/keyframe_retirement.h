#pragma once

#include <vector>

#include "mba_vo/mapping/window_state.h"

namespace mba_vo {

struct KeyframeRetirementOptions {
  int max_keyframes = 7;      // at most one less remain
  int min_keyframes = 5;      // visibility alone never leaves fewer than these
  double min_visible = 0.05;  // of a keyframe's points in the newest keyframe
};

/// Share of the points ever hosted by `keyframe` that the newest keyframe still sees.
double visibleFraction(const WindowState& state, int keyframe);

/// Which keyframes should leave now (DSO, Sec. 3.1): those of whose points the newest keyframe sees almost none, then
/// those that crowd the rest, s_i = sqrt(d(i, newest)) sum_j 1 / d(i, j). The two newest always stay.
std::vector<int> keyframesToRetire(const WindowState& state, const KeyframeRetirementOptions& options);

}  // namespace mba_vo
