#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "mba_vo/tracking/keyframe_policy.h"
#include "mba_vo/tracking/reference.h"
#include "mba_vo/tracking/tracked_frame.h"
#include "mba_vo/trajectory/finite_difference_velocity.h"

namespace mba_vo {

/// Chooses the frames that become keyframes: by how the view has changed, sooner in a map of few keyframes, or because
/// the newest keyframe no longer explains what is seen, its depths being too rough for the way that the camera has gone
/// (as DSO does). One becomes a keyframe once the frame after it has been tracked: the motion on both sides then tells
/// how much the keyframe itself is blurred, without looking at its blur.
class KeyframeSelector {
 public:
  explicit KeyframeSelector(const KeyframePolicyConfig& config) : policy_(config) {}

  /// The next frame. `newest`: the newest keyframe; the tracker may still be using an older one. Returns the frame
  /// that is to become a keyframe now, else null. While the window is `busy` with the newest one, the next waits,
  /// unless its view is being left.
  TrackedFrameConstPtr add(const TrackedFrameConstPtr& frame, const SE3& T_map_camera, const Reference& newest,
                           bool busy);
  /// Whether one waits only because the window was busy.
  bool hasReady() const { return candidate_ && ready_; }
  TrackedFrameConstPtr takeReady();
  /// The camera is lost: the frame that waits for the one after it waits no longer, for on fast turns what it has seen
  /// is all there is to go on with. Null if none waits.
  TrackedFrameConstPtr takeNow();
  /// Of the frame that was returned last [m/s, rad/s, body frame].
  const BodyMotion& motion() const { return taken_motion_; }
  /// The same where that frame could not wait for the one after it, which has come now.
  std::optional<BodyMotion> takeMotionAfterwards() { return std::exchange(motion_afterwards_, std::nullopt); }
  /// A frame was tracked again.
  void revise(const TrackedFrameConstPtr& frame);
  /// Begins anew, with the camera at this pose.
  void restart(std::int64_t mid_exposure_ns, const SE3& T_map_camera);
  void reset();

 private:
  struct FirstError {
    KeyframeId keyframe;
    double pixel_error;  // of the first frame that was tracked against it [px]
  };

  bool isExplainedBadly(const TrackedFrame& frame, KeyframeId newest);

  KeyframePolicy policy_;
  std::optional<FirstError> first_error_;
  FiniteDifferenceVelocity motion_;
  BodyMotion taken_motion_;
  bool hurried_ = false;  // the frame that was returned last could not wait, and none has come since
  std::optional<BodyMotion> motion_afterwards_;
  TrackedFrameConstPtr candidate_;  // becomes a keyframe
  bool ready_ = false;              // the frame after it has been seen
};

}  // namespace mba_vo
