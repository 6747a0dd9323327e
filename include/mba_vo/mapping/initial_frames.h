#pragma once

#include <vector>

#include "mba_vo/mapping/mapper_config.h"
#include "mba_vo/tracking/reference.h"
#include "mba_vo/tracking/tracked_frame.h"

namespace mba_vo {

/// A frame that was tracked from the pose which the initial map knows of it.
struct InitialFrame {
  TrackedFrameConstPtr tracked;
  BodyMotion motion;  // by the poses before and after
};

/// A few frames that lead from the initial map's reference to where the camera is by now, the newest but one at the
/// end, tracked against the reference. Ends before the first that is lost.
std::vector<InitialFrame> trackInitialFrames(const MapperConfig& config, const InitialMap& initial,
                                             const Reference& first_keyframe);

}  // namespace mba_vo
