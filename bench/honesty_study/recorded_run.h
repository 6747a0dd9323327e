#pragma once

#include <string>
#include <vector>

#include "mba_vo/odometry/config.h"
#include "mba_vo/tracking/reference.h"
#include "mba_vo/tracking/tracked_frame.h"
#include "mba_vo/trajectory/trajectory_store.h"

namespace mba_vo::study {

/// A frame as it was first reported, with a pose.
struct Reported {
  TrackedFrameConstPtr tracked;
  ReferenceConstPtr reference;  // that it was aligned to
};

struct RecordedRun {
  std::vector<Reported> reported;
  std::vector<TrajectoryEntry> trajectory;
};

/// Runs the odometry over a sequence folder without its first `skip` images, a new keyframe being used at once.
RecordedRun runOver(const std::string& folder, const OdometryConfig& config, int skip);

}  // namespace mba_vo::study
