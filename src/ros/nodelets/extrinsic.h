#pragma once

#include <string>

#include "mba_vo/geometry/se3.h"

namespace mba_vo {

/// Pose of the camera (optical frame `camera_frame`) on the base, from TF, waiting at most `wait` [s] of wall time for
/// it. If TF knows none, the base is the camera itself with the axes of REP-103.
SE3 lookupExtrinsic(const std::string& base_frame, const std::string& camera_frame, double wait);

}  // namespace mba_vo
