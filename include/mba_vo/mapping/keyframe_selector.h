#pragma once

#include <cstdint>

#include "mba_vo/tracking/keyframe_policy.h"
#include "mba_vo/tracking/reference.h"
#include "mba_vo/tracking/tracked_frame.h"
#include "mba_vo/trajectory/finite_difference_velocity.h"

namespace mba_vo {

/// Chooses the frames that become keyframes. One becomes a keyframe once the frame after it has been tracked: the
/// motion on both sides then tells how much the keyframe itself is blurred, without looking at its blur.
class KeyframeSelector {
 public:
  explicit KeyframeSelector(const KeyframePolicyConfig& config) : policy_(config) {}

  /// The next frame. `newest`: the newest keyframe; the tracker may still be using an older one. Returns the frame
  /// before it if that is to become a keyframe, else null.
  TrackedFrameConstPtr add(const TrackedFrameConstPtr& frame, const SE3& T_map_camera, const Reference& newest);
  /// The camera is lost: the frame that waits for the one after it waits no longer, for on fast turns what it has seen
  /// is all there is to go on with. Null if none waits.
  TrackedFrameConstPtr takeNow();
  /// Of the frame that `add` or `takeNow` returned [m/s, rad/s, body frame].
  const BodyMotion& motion() const { return taken_motion_; }
  /// A frame was tracked again.
  void revise(const TrackedFrameConstPtr& frame);
  /// Begins anew, with the camera at this pose.
  void restart(std::int64_t mid_exposure_ns, const SE3& T_map_camera);
  void reset();

 private:
  KeyframePolicy policy_;
  FiniteDifferenceVelocity motion_;
  BodyMotion taken_motion_;
  TrackedFrameConstPtr candidate_;  // becomes a keyframe with the next frame
};

}  // namespace mba_vo
