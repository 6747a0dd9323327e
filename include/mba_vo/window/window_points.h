#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "mba_vo/window/window.h"
#include "mba_vo/window/window_state.h"

namespace mba_vo {

/// The active points of a window as its callers see them, in the order of the state.
std::vector<WindowPoint> describePoints(const WindowState& state);

/// Sets the slopes of those of the state's points that are among `points`, which have the order of the state; nullopt:
/// it stays.
void setSlopes(WindowState& state, const std::vector<WindowPoint>& points,
               const std::function<std::optional<Eigen::Vector2d>(const WindowPoint&)>& slopeOf);

}  // namespace mba_vo
