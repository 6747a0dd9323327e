#include "mba_vo/tracking/tracked_frame.h"

namespace mba_vo {

const char* toString(TrackingStatus status) {
  switch (status) {
    case TrackingStatus::kInitializing:
      return "INITIALIZING";
    case TrackingStatus::kTracking:
      return "TRACKING";
    case TrackingStatus::kDegraded:
      return "DEGRADED";
    case TrackingStatus::kLost:
      return "LOST";
  }
  return "UNKNOWN";
}

}  // namespace mba_vo
