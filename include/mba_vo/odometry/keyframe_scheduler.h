#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "mba_vo/odometry/waiting_frames.h"
#include "mba_vo/tracking/keyframe_policy.h"
#include "mba_vo/tracking/tracked_frame.h"

namespace mba_vo {

/// How badly a new keyframe is needed, by the newest frame that was tracked (1 = the next sharp one would do), and what
/// that means for the frames until it comes.
class KeyframeScheduler {
 public:
  static constexpr double kLost = std::numeric_limits<double>::infinity();  // need of a frame that was not tracked

  explicit KeyframeScheduler(const KeyframePolicy& policy) : policy_(policy) {}

  /// Decides whether the tracked frame asks for a keyframe, and whether it is provisional: once the view of the
  /// reference is being left and the mapper has been asked, frames are, until the keyframe is there; if that takes too
  /// long, they are not. `mapped`: the mapper has used the frame before.
  void judge(const Reference& reference, bool mapped, TrackedFrame& tracked);
  /// True while waiting frames have to go on waiting for the keyframe that the last ones asked for. Measured in the
  /// time of the frames, so that it does not depend on the machine. A frame that had its chance waits for nothing.
  bool holds(const WaitingFrames& waiting);
  /// A keyframe has come.
  void meet();

  double need() const { return need_; }
  /// The frame is worth another look when there is a better reference.
  bool isWorthRevision() const;
  /// What has been seen with such a need must not be relied on.
  static bool isBad(double need);

 private:
  bool isProvisional(const Frame& frame);

  KeyframePolicy policy_;
  double need_ = 0.0;
  int frames_since_request_ = 0;  // that a keyframe was asked for, counting the asking one
  std::optional<std::int64_t> hold_since_ns_;
  std::optional<std::int64_t> provisional_since_ns_;
};

}  // namespace mba_vo
