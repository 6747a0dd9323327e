#pragma once

#include <memory>
#include <string>

#include "mba_vo/tracking/tracked_frame.h"

namespace mba_vo {

/// The result for a frame without a pose.
std::shared_ptr<TrackedFrame> untracked(const FrameConstPtr& frame, TrackingStatus status, const std::string& reason);

/// Nothing that the tracker trusts, if there is this to be said against it.
void degrade(TrackedFrame& tracked, const std::string& reason);

}  // namespace mba_vo
