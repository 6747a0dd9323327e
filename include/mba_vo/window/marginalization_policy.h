#pragma once

#include <vector>

#include "mba_vo/window/window_state.h"

namespace mba_vo {

struct MarginalizationPolicyOptions {
  int max_keyframes = 30;             // at most one less remain
  int min_keyframes = 7;              // down to one less, keyframes leave for their residuals
  int max_residuals = 5000;           // good ones among those that remain
  int max_residuals_blurred = 20000;  // the same during a turn, and for a while after it
  double long_blur_px = 25.0;         // blur of a keyframe that tells of such a turn
};

/// Which keyframes should leave now: those that crowd the rest, s_i = sqrt(d(i, newest)) sum_j 1 / d(i, j) (DSO, Sec.
/// 3.1). The two newest always stay. Where points are few, as on fast turns, the window has more keyframes for the same
/// work; and those of which the newest sees nothing may stay, unlike DSO's: the camera often turns back. A keyframe
/// with a long blur says little of where it is: what a turn begins with must be in the window with what it ends with.
std::vector<int> chooseKeyframesToMarginalize(const WindowState& state, const MarginalizationPolicyOptions& options);

}  // namespace mba_vo
