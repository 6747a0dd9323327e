#include "mba_vo/odometry/frame_judge.h"

#include "mba_vo/odometry/tracking_results.h"
#include "mba_vo/tracking/motion_state.h"

namespace mba_vo {
namespace {

constexpr double kGap = 2.5;  // times the interval before

}  // namespace

void FrameJudge::judge(TrackedFrame& tracked, bool lost, double seconds) {
  if (lost || isGap(seconds)) judgeFirstAfterLoss(config_, tracked);
  if (!tracked.tracked()) return;
  usual_interval_ = seconds;
  if (pixel_error_gate_.isExceededBy(tracked.pixel_error)) {
    degrade(tracked, "the image differs from the reference much more than others do");
  }
  if (expected_error_gate_.isExceededBy(tracked.expected_error)) {
    degrade(tracked, "the pose is known much worse than others are");
  }
  pixel_error_gate_.add(tracked.pixel_error);
  expected_error_gate_.add(tracked.expected_error);
}

void FrameJudge::reset() {
  pixel_error_gate_.reset();
  expected_error_gate_.reset();
  usual_interval_ = 0.0;
}

/// Slow cameras have long intervals, but regular ones.
bool FrameJudge::isGap(double seconds) const {
  return seconds > kLongestPrediction && usual_interval_ > 0.0 && seconds > kGap * usual_interval_;
}

}  // namespace mba_vo
