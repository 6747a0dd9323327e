#include "mba_vo/odometry/tracking_results.h"

namespace mba_vo {

std::shared_ptr<TrackedFrame> untracked(const FrameConstPtr& frame, TrackingStatus status, const std::string& reason) {
  auto tracked = std::make_shared<TrackedFrame>();
  tracked->frame = frame;
  tracked->status = status;
  tracked->reason = reason;
  return tracked;
}

void degrade(TrackedFrame& tracked, const std::string& reason) {
  if (tracked.status != TrackingStatus::kTracking) return;
  tracked.status = TrackingStatus::kDegraded;
  tracked.reason = reason;
}

}  // namespace mba_vo
