#pragma once

#include <vector>

#include "mba_vo/mapping/window_state.h"

namespace mba_vo {

struct KeyframeRetirementOptions {
  int max_keyframes = 13;    // at most one less remain
  int min_keyframes = 7;     // down to one less, keyframes leave for their residuals
  int max_residuals = 5000;  // good ones among those that remain
};

/// Which keyframes should leave now: those that crowd the rest, s_i = sqrt(d(i, newest)) sum_j 1 / d(i, j) (DSO, Sec.
/// 3.1). The two newest always stay. Where points are few, as on fast turns, the window has more keyframes for the same
/// work; and those of which the newest sees nothing may stay, unlike DSO's: the camera often turns back.
std::vector<int> keyframesToRetire(const WindowState& state, const KeyframeRetirementOptions& options);

}  // namespace mba_vo
