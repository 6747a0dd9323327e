#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "mba_vo/tracking/tracked_frame.h"
#include "mba_vo/tracking/tracker.h"
#include "mba_vo/trajectory/pose_interpolation.h"

namespace mba_vo {

/// The result for a frame without a pose.
std::shared_ptr<TrackedFrame> untracked(const FrameConstPtr& frame, TrackingStatus status, const std::string& reason);

/// The same result for an image that shows the same exposure again, under its number and stamp.
TrackedFrameConstPtr stampedAgain(const TrackedFrame& tracked, std::uint64_t sequence, std::int64_t stamp_ns);

/// `frames`, in order, that were left out between a pose and the next that was tracked, relative to the same reference:
/// with a covariance that says how far the camera may have swung to either side meanwhile. `mean_depth` [m].
std::vector<TrackedFrameConstPtr> placedBetween(const StampedPose& begin, const TrackedFrame& end,
                                                const std::vector<FrameConstPtr>& frames,
                                                const MotionPriorConfig& prior, double mean_depth);

/// Nothing that the tracker trusts, if there is this to be said against it.
void degrade(TrackedFrame& tracked, const std::string& reason);

/// After a loss anything may seem to fit: only a pose that is good by itself ends it, and the next one must agree.
void judgeFirstAfterLoss(const TrackerConfig& config, TrackedFrame& tracked);

}  // namespace mba_vo
