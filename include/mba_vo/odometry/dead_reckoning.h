#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "mba_vo/initialization/orientation_tracking.h"
#include "mba_vo/odometry/tracking_state.h"

namespace mba_vo {

/// Where the camera is in odom while nothing can be aligned to a map: it turns as its images turn, and for a little
/// while it goes on as fast as it last did.
class DeadReckoning {
 public:
  /// `memory`: for how long it tells where the camera was [s].
  DeadReckoning(const TrackerConfig& config, double memory)
      : orientation_(config), acceleration_(config.motion_prior.linear_acceleration), memory_(memory) {}

  /// The pose of a frame is known, by an alignment to the map: what comes is relative to it. `depth` of the scene [m].
  void beginAt(const TrackedFrame& tracked, const SE3& T_odom_camera, double depth);
  /// The next frame. True if its rotation was measured.
  bool track(const FrameConstPtr& frame);

  /// Of the last frame.
  const SE3& T_odom_camera() const { return poses_.back().T_odom_camera; }
  /// Standard deviation of the position that was predicted for the last frame, in depths; infinite if nothing is known.
  double positionSigma() const;
  /// How the camera has turned from one frame to another, if both are remembered and it was measured.
  std::optional<CameraTurn> turnBetween(std::int64_t from_ns, std::int64_t to_ns) const;
  /// Of the last one that is not after then, or else of the first one known.
  const SE3& T_odom_cameraAt(std::int64_t mid_exposure_ns) const;
  /// Of the last frame: its rotation and angular velocity, relative to an earlier frame; no position.
  ExposureTrajectory turn() const { return orientation_.last(); }
  /// Of the last frame, camera frame [m/s, rad/s]: as it turns, and as it went when its pose was known.
  Vector6 velocity() const;
  /// Of its measured rotation [rad^2], in its own axes: what the position is wrong by looks like a turn.
  Eigen::Matrix3d covariance() const;
  /// Nothing is known.
  void reset();

 private:
  struct Pose {
    std::int64_t mid_exposure_ns = 0;
    SE3 T_odom_camera;
    bool turn_measured = true;                                   // since the frame before
    Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // camera frame [rad/s]
  };

  OrientationTracking orientation_;
  double acceleration_;  // standard deviation, of what the camera does [depths/s^2]
  double memory_;        // [s]
  FrameConstPtr first_;  // whose pose is known; null at the very beginning
  double depth_ = 0.0;   // [m]
  SE3 T_odom_first_;
  Eigen::Vector3d velocity_odom_ = Eigen::Vector3d::Zero();  // of then, as far as it was known [m/s]
  double velocity_variance_ = 0.0;                           // of it [m^2/s^2]
  std::deque<Pose> poses_ = {Pose()};                        // since then, by time; never empty
};

}  // namespace mba_vo
