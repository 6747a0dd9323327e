#include "mba_vo/odometry/tracking_results.h"

namespace mba_vo {
namespace {

constexpr double kFoundInliers = 0.75;  // of the pixels, as for finding a camera by its keyframes

}  // namespace

std::shared_ptr<TrackedFrame> untracked(const FrameConstPtr& frame, TrackingStatus status, const std::string& reason) {
  auto tracked = std::make_shared<TrackedFrame>();
  tracked->frame = frame;
  tracked->status = status;
  tracked->reason = reason;
  return tracked;
}

TrackedFrameConstPtr stampedAgain(const TrackedFrame& tracked, std::uint64_t sequence, std::int64_t stamp_ns) {
  auto frame = std::make_shared<Frame>(*tracked.frame);
  frame->sequence = sequence;
  frame->stamp_ns = stamp_ns;
  auto again = std::make_shared<TrackedFrame>(tracked);
  again->frame = frame;
  return again;
}

void degrade(TrackedFrame& tracked, const std::string& reason) {
  if (tracked.status != TrackingStatus::kTracking) return;
  tracked.status = TrackingStatus::kDegraded;
  tracked.reason = reason;
}

void judgeFirstAfterLoss(const TrackerConfig& config, TrackedFrame& tracked) {
  const bool poor = tracked.inlier_fraction < kFoundInliers || tracked.pixel_error > config.degraded_pixel_error;
  if (tracked.tracked() && poor) tracked.status = TrackingStatus::kLost;
  degrade(tracked, "found again by prediction, which no other frame has confirmed yet");
}

}  // namespace mba_vo
