#pragma once

#include <mba_vo/Status.h>

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

}  // namespace mba_vo
