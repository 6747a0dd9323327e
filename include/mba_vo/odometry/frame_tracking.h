#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "mba_vo/odometry/frame_judge.h"
#include "mba_vo/odometry/tracking_state.h"
#include "mba_vo/tracking/exposure_estimator.h"
#include "mba_vo/tracking/lost_timer.h"
#include "mba_vo/tracking/tracker.h"
#include "mba_vo/trajectory/odometry_velocity.h"

namespace mba_vo {

/// Aligns frame after frame to the reference in use, each from what the last one told, and keeps odometry continuous
/// when the reference changes. It does what it is told; when something is done, TrackingLoop decides.
class FrameTracking {
 public:
  explicit FrameTracking(const TrackerConfig& config);

  /// Null if there is no map.
  const ReferenceConstPtr& reference() const { return reference_; }
  /// What the last frame tells about the next one, relative to the reference.
  const TrackingState& state() const { return state_; }
  bool lost() const { return lost_.lost(); }

  /// A map begins with what its reference's hint says; the camera was at `T_odom_hint` then.
  void begin(const ReferenceConstPtr& reference, const SE3& T_odom_hint);
  /// Goes on with another keyframe of the map. Returns T_new_old of the two references.
  SE3 changeReference(const ReferenceConstPtr& reference);
  /// As changeReference, of a lost camera that the mapper has found where the hint says. Odometry goes on from where it
  /// was then, `T_odom_hint`, and map -> odom takes the rest.
  SE3 recover(const ReferenceConstPtr& reference, const SE3& T_odom_hint);
  /// The same keyframe with a better image.
  void replaceImage(const ReferenceConstPtr& reference) { reference_ = reference; }
  /// There is no map any more.
  void leave();
  /// Goes on from another frame than the last one.
  void goOnFrom(const TrackingState& state) { state_ = state; }
  void find() { lost_.find(); }
  void lose(std::int64_t mid_exposure_ns, bool blind) { lost_.lose(mid_exposure_ns, blind); }
  /// As if nothing had ever been tracked.
  void reset();

  /// Aligns the next frame and goes on from it, if it is not lost. `turn`: since state(), if that is known.
  std::shared_ptr<TrackedFrame> track(const FrameConstPtr& given, const std::optional<CameraTurn>& turn);
  /// The same of a frame far from the last one, but only if it is clearly where it seems to be: else nothing has
  /// changed, and null is returned.
  std::shared_ptr<TrackedFrame> leapTo(const FrameConstPtr& given, const std::optional<CameraTurn>& turn);
  /// Aligns a frame from what `newest` tells, which goes on from it, while state() stays. Null if it is lost.
  std::shared_ptr<TrackedFrame> trackAhead(const FrameConstPtr& given, TrackingState& newest);

  /// At which the points of the reference lie, by the mean of their inverse depths [m]; 0 if they lie nowhere.
  double meanDepth() const;

  /// Camera to odom at mid-exposure of the last frame with a pose; never rewritten.
  const SE3& T_odom_camera() const { return T_odom_camera_; }
  /// How it moved then.
  const VelocityEstimate& velocity() const { return velocity_.last(); }
  /// What is not aligned to a map may still be known.
  void moveTo(const SE3& T_odom_camera) { T_odom_camera_ = T_odom_camera; }
  /// While lost: camera to odom if it goes on moving as it last did, which nothing measures. nullopt while not lost.
  std::optional<SE3> predicted_T_odom_camera(std::int64_t mid_exposure_ns) const;
  SE3 T_reference_odom() const { return T_odom_reference_.inverse(); }
  /// odom to map by the reference: T_map_ref T_odom_ref^-1; the identity without one.
  SE3 T_map_odom() const;

 private:
  /// With the exposure and the row time that are known by now.
  FrameConstPtr asKnownNow(const FrameConstPtr& frame) const;
  std::shared_ptr<TrackedFrame> align(const FrameConstPtr& given, const std::optional<CameraTurn>& turn) const;
  FrameConstPtr withExposureKnownNow(const FrameConstPtr& frame) const;  // of one that nobody told
  void learnExposure(const std::shared_ptr<TrackedFrame>& tracked, const FrameConstPtr& given);
  void goOnFrom(const TrackedFrame& tracked);
  void moveWith(const TrackedFrame& tracked);
  /// Through the poses that came with the new snapshot: map coordinates of different moments do not mix.
  SE3 T_newReference_oldReference(const Reference& next) const;

  TrackerConfig config_;
  Tracker tracker_;
  ExposureEstimator exposures_;
  FrameJudge judge_;
  LostTimer lost_;
  ReferenceConstPtr reference_;
  TrackingState state_;
  SE3 T_odom_camera_;
  OdometryVelocity velocity_;
  SE3 T_odom_reference_;
};

}  // namespace mba_vo
