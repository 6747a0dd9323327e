#pragma once

#include <vector>

#include "mba_vo/window/pair_geometry.h"

namespace mba_vo {

/// By point: whether a step of keyframes and inverse depths moves its projection by less than `limit` px in all
/// keyframes where it has a residual. To first order, as if it moved across the line of sight.
std::vector<bool> hardlyMove(const WindowState& state, const std::vector<PairGeometry>& pairs,
                             const Eigen::VectorXd& keyframe_steps, const Eigen::VectorXd& depth_steps, double limit);

}  // namespace mba_vo
