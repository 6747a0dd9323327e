#pragma once

#include "mba_vo/tracking/residual_gate.h"
#include "mba_vo/tracking/tracker.h"

namespace mba_vo {

/// Looks at tracked frames with what is known of those before, and takes trust from the doubtful ones.
class FrameJudge {
 public:
  explicit FrameJudge(const TrackerConfig& config) : config_(config) {}

  /// `lost`: the frame before was. `seconds`: since the last frame that was tracked. After a gap in the images, as
  /// after a loss, nothing has predicted the pose: a poor one counts as LOST, and a good one has to be confirmed by the
  /// next frame. So does one that fits, or is known, much worse than others did.
  void judge(TrackedFrame& tracked, bool lost, double seconds);
  /// Another map begins.
  void reset();

 private:
  bool isGap(double seconds) const;

  TrackerConfig config_;
  ResidualGate pixel_error_gate_;
  ResidualGate expected_error_gate_;
  double usual_interval_ = 0.0;  // between the last two frames [s]; 0 = unknown
};

}  // namespace mba_vo
