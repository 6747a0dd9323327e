#include "mba_vo/odometry/tracking_results.h"

#include "mba_vo/geometry/angles.h"

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

std::vector<TrackedFrameConstPtr> placedBetween(const StampedPose& begin, const TrackedFrame& end,
                                                const std::vector<FrameConstPtr>& frames,
                                                const MotionPriorConfig& prior, double mean_depth) {
  const std::int64_t end_ns = end.frame->mid_exposure_ns;
  const StampedPose last{end_ns, end.trajectory.T_reference_mid, end.trajectory.velocity};
  const double interval = 1e-9 * static_cast<double>(end_ns - begin.mid_exposure_ns);  // [s]
  Vector6 swing;  // to each side, if the acceleration swings once in the meantime [m, rad]
  swing.head<3>().setConstant(prior.linear_acceleration * mean_depth);
  swing.tail<3>().setConstant(prior.angular_acceleration);
  swing *= interval * interval / (4.0 * kPi * kPi);
  std::vector<TrackedFrameConstPtr> placed;
  for (const FrameConstPtr& frame : frames) {
    const StampedPose there = interpolatePose(begin, last, frame->mid_exposure_ns);
    const auto between = untracked(frame, TrackingStatus::kDegraded, "left out to catch up, placed by its neighbours");
    between->reference = end.reference;
    between->trajectory = end.trajectory;
    between->trajectory.T_reference_mid = there.T_map_camera;
    between->trajectory.velocity = there.velocity;
    between->brightness = end.brightness;
    between->covariance = end.covariance;
    between->covariance.diagonal().head<6>() += swing.cwiseAbs2();
    between->expected_error = end.expected_error;
    placed.push_back(between);
  }
  return placed;
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
