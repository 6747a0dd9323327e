#pragma once

#include <vector>

#include "mba_vo/window/window.h"

namespace mba_vo {

/// Turns WindowPoint::variance into that of an inverse depth.
inline constexpr double kResidualVariance = 25.0;  // [spread^2]

/// The window's `points` as seen by a `camera` at T_map_camera, those outside the image left out. `motion`: of the
/// camera, for a rolling shutter.
std::vector<ReferencePoint> projectPoints(const Window& window, const std::vector<WindowPoint>& points,
                                          const PinholeCamera& camera, const SE3& T_map_camera,
                                          const BodyMotion& motion = {});
/// The same, seen by one of the window's own keyframes.
std::vector<ReferencePoint> pointsSeenBy(const Window& window, const std::vector<WindowPoint>& points,
                                         KeyframeId keyframe);

}  // namespace mba_vo
