#pragma once

#include "mba_vo/window/window.h"
#include "mba_vo/window/window_state.h"

namespace mba_vo {

/// Adds what is known of a keyframe before anything is marginalised: of the first one its pose and brightness, which
/// are the gauge, of others that their brightness changes but little.
void addPriorOf(int keyframe, const WindowConfig& config, WindowState& state);

/// Keyframes up to which the first correction of the lens may cost all that is marginalised. Cameras that are 1 % wrong
/// are corrected with keyframe 3 to 13; without it maps collapsed later, in turns
/// (docs/decisions/2026-11-30-late-corrections.md).
inline constexpr int kMostToForget = 14;

/// Forgets all that was marginalised: the keyframes that are left, free of their first estimates, begin as a new
/// window.
void beginPriorAnew(const WindowConfig& config, WindowState& state);

}  // namespace mba_vo
