#pragma once

#include <optional>
#include <vector>

#include "mba_vo/window/window.h"
#include "mba_vo/window/window_state.h"

namespace mba_vo {

/// The active points of a window as its callers see them, in the order of the state.
std::vector<WindowPoint> describePoints(const WindowState& state);

std::vector<double> inverseDepths(const WindowState& state);  // in the same order [1/m]

/// Sets the slopes of the state's points, in the same order; nullopt: it stays.
void setSlopes(WindowState& state, const std::vector<std::optional<Eigen::Vector2d>>& slopes);

}  // namespace mba_vo
