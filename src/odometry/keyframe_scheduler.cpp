#include "mba_vo/odometry/keyframe_scheduler.h"

namespace mba_vo {
namespace {

constexpr double kRevisionNeed = 1.5;
constexpr double kProvisionalNeed = 2.0;
constexpr double kHoldingNeed = 4.0;
constexpr double kLongestHold = 0.3;         // [s] for a keyframe that was asked for
constexpr double kLongestProvisional = 0.5;  // [s]
constexpr int kFramesUntilKeyframe = 2;      // the mapper looks at one more frame before it makes a keyframe

double secondsBetween(std::int64_t from_ns, std::int64_t to_ns) { return 1e-9 * static_cast<double>(to_ns - from_ns); }

}  // namespace

void KeyframeScheduler::judge(const Reference& reference, bool mapped, TrackedFrame& tracked) {
  need_ = policy_.need(reference, tracked.measures, tracked.brightness);
  tracked.keyframe_requested = policy_.takes(reference, tracked.measures, tracked.brightness);
  if (!mapped && (tracked.keyframe_requested || frames_since_request_ > 0)) ++frames_since_request_;
  tracked.provisional = isProvisional(*tracked.frame);
}

bool KeyframeScheduler::holds(const WaitingFrames& waiting) {
  if (waiting.front().in_time || frames_since_request_ < kFramesUntilKeyframe || need_ < kHoldingNeed) return false;
  const std::int64_t newest_ns = waiting.back().frame->mid_exposure_ns;
  if (!hold_since_ns_) hold_since_ns_ = newest_ns;
  return secondsBetween(*hold_since_ns_, newest_ns) < kLongestHold;
}

void KeyframeScheduler::meet() {
  frames_since_request_ = 0;
  hold_since_ns_.reset();
  provisional_since_ns_.reset();
}

bool KeyframeScheduler::isWorthRevision() const { return need_ >= kRevisionNeed; }

bool KeyframeScheduler::isBad(double need) { return need >= kProvisionalNeed; }

bool KeyframeScheduler::isProvisional(const Frame& frame) {
  if (!provisional_since_ns_ && isBad(need_) && frames_since_request_ > kFramesUntilKeyframe) {
    provisional_since_ns_ = frame.mid_exposure_ns;
  }
  return provisional_since_ns_ && secondsBetween(*provisional_since_ns_, frame.mid_exposure_ns) < kLongestProvisional;
}

}  // namespace mba_vo
