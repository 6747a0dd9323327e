#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "mba_vo/geometry/body_motion.h"
#include "mba_vo/geometry/se3.h"
#include "mba_vo/tracking/tracked_frame.h"

namespace mba_vo {

/// What the blur, or the rows of a rolling shutter, tell about the velocity [m/s, rad/s, body frame], and those rows
/// about how a turn changes, too. None where the exposure is unknown or instantaneous, unless the shutter rolls.
struct ObservedMotion {
  Vector6 velocity = Vector6::Zero();
  std::optional<Eigen::Vector3d> angular_acceleration;  // [rad/s^2]
};
std::optional<ObservedMotion> observedMotion(const TrackedFrame& frame);

/// Motion during an exposure, by the poses of the frames before and after it. A blurred image compared with a
/// blurred reference tells only by how much more the one is blurred than the other: a reference's error goes over to
/// the motion measured in the next frame, and from there to the next reference. The poses at mid-exposure, which hardly
/// depend on the blur, hold that back.
class FiniteDifferenceVelocity {
 public:
  /// Adds the next frame: its mid pose and what itself tells of its motion, if anything.
  /// Must be increasing in time; one that is not is ignored.
  void add(std::int64_t mid_exposure_ns, const SE3& T_map_camera, const std::optional<ObservedMotion>& measured);

  /// There is a frame on both sides of the last but one, near enough to tell of it.
  bool knowsBothSides() const;
  /// There is a frame before the last one, near enough to tell of it.
  bool knowsBefore() const;
  /// Of the last but one frame [m/s, rad/s, body frame]. Zero if fewer than two poses are known, or those on both sides
  /// are too far away in time.
  Vector6 velocityOfMiddle() const;
  /// The same with the acceleration, that of a constant one through the three poses; 0 if there are fewer. Where the
  /// frame itself tells how its turn changes, that and the poses count by half: what is faster than the frames, they
  /// do not see; the rows see it, but not well.
  BodyMotion motionOfMiddle() const;
  /// Of the last frame, while none after it is known: as between it and the one before, and for a turn what it has
  /// gained by then. The rows of a rolling shutter, or a frame that follows none, are believed instead.
  BodyMotion motionOfLast() const;
  /// The same, as near to the truth as is known: a way goes on as it changed, and of a turn what is measured counts as
  /// well. Not for a reference: its own error is in what is measured, and would not fade.
  BodyMotion bestOfLast() const;

 private:
  struct Pose {
    std::int64_t ns;
    SE3 T_map_camera;
    std::optional<ObservedMotion> measured;
  };
  /// From the pose before the one of number i: time, and the velocity on the way.
  double secondsTo(std::size_t i) const;
  Vector6 velocityTo(std::size_t i) const;
  Eigen::Vector3d turnGainedTo(std::size_t i) const;
  Eigen::Vector3d measuredTurn(std::size_t i) const;

  std::deque<Pose> poses_;
};

}  // namespace mba_vo
