#pragma once

#include <memory>
#include <optional>

#include "mba_vo/tracking/motion_state.h"
#include "mba_vo/tracking/tracker.h"
#include "mba_vo/trajectory/finite_difference_velocity.h"

namespace mba_vo {

/// Rotation of the camera without a map: frames are aligned, blur and all, to one of their number as if all
/// that is seen were infinitely far away. Where the camera only turns, that is as good as with depths.
class OrientationTracking {
 public:
  explicit OrientationTracking(const TrackerConfig& config);

  /// What comes is relative to this frame, which turned so [rad/s], in its own axes.
  void begin(const FrameConstPtr& frame, const Eigen::Vector3d& angular_velocity);
  /// Aligns the next frame. True if its rotation was measured, or it is the first since reset().
  bool track(const FrameConstPtr& frame);
  /// What is known of the last frame: its rotation to the first one, and its angular velocity, measured or
  /// predicted. Translation is zero.
  ExposureTrajectory last() const;
  /// Of the last frame's measured rotation [rad^2], in its own axes.
  const Eigen::Matrix3d& covariance() const { return covariance_; }
  void reset();

 private:
  void add(TrackedFrame& tracked);
  void changeReference(const FrameConstPtr& frame, const AffineBrightness& brightness);
  /// Predicts how the camera has turned since the last frame by features, if there are any: they find turns that come
  /// as a surprise, the first of all for one, where an alignment may end in a wrong valley.
  std::optional<MotionPrior> priorByFeatures(const FrameConstPtr& frame) const;

  Tracker tracker_;
  TrackerConfig config_;
  std::shared_ptr<const Reference> reference_;
  FrameConstPtr last_frame_;
  SE3 T_first_reference_;
  MotionState motion_;              // relative to the reference
  FiniteDifferenceVelocity turns_;  // relative to the first frame
  AffineBrightness brightness_;
  Eigen::Matrix3d covariance_ = Eigen::Matrix3d::Zero();
};

}  // namespace mba_vo
