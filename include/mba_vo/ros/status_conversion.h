#pragma once

#include <string>

#include <mba_vo/Status.h>

#include "mba_vo/ros/image_assembler.h"
#include "mba_vo/tracking/tracked_frame.h"

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

/// The exposure_source in mba_vo/Status of an image and what became of it.
inline std::string exposureSource(const InputImage& image, const TrackedFrame& tracked) {
  if (tracked.exposure_estimate.used) {
    return image.exposure ? "corrected" : "estimated";
  }
  if (!tracked.frame->exposure) {
    return "unknown";
  }
  return image.exposure_from_topic ? "topic" : "parameter";
}

}  // namespace mba_vo
