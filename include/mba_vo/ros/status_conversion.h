#pragma once

#include <string>

#include <mba_vo/Status.h>

#include "mba_vo/odometry/tracker_pipeline.h"

namespace mba_vo {

/// The state in mba_vo/Status that belongs to a tracking status.
inline std::uint8_t toState(TrackingStatus status) {
  switch (status) {
    case TrackingStatus::kTracking:
      return Status::TRACKING;
    case TrackingStatus::kDegraded:
      return Status::DEGRADED;
    case TrackingStatus::kLost:
      return Status::LOST;
    default:
      return Status::INITIALIZING;
  }
}

/// The exposure_source in mba_vo/Status of an image that has its result.
inline std::string exposureSource(const TrackerStep& step) {
  const TrackedFrame& tracked = *step.message.tracked;
  if (tracked.exposure_estimate.used) {
    return step.exposure ? "corrected" : "estimated";
  }
  if (!tracked.frame->exposure) {
    return "unknown";
  }
  return step.exposure_from_topic ? "topic" : "parameter";
}

}  // namespace mba_vo
