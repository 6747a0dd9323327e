#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "mba_vo/odometry/config.h"
#include "mba_vo/tracking/tracker.h"

namespace mba_vo {

/// The loop around the Tracker: keeps the motion prior and the newest reference, decides the status, and keeps odometry
/// continuous when a reference is adopted. Not thread-safe: one thread calls it.
class TrackingLoop {
 public:
  explicit TrackingLoop(const OdometryConfig& config);
  ~TrackingLoop();

  /// Every frame gives exactly one result; never null. Without time to spare the orientation is not tracked while there
  /// is no map.
  TrackedFrameConstPtr process(const FrameConstPtr& frame, bool has_time = true);

  /// Takes a newer snapshot; the prior is re-expressed through the poses that came with it. False if it is of no use.
  /// The first snapshot of a map comes with a hint about a frame of the past: frames that came after it and were
  /// reported as INITIALIZING have waited to be tracked now, so that nothing has to be predicted over a long gap. With
  /// later ones the frames wait that were lost, or saw the older reference badly, and come after the new one's image;
  /// unless it may not go back, for want of time.
  bool take(const ReferenceConstPtr& reference, bool may_go_back = true);
  /// Tracks the oldest waiting frame: another, late result, for the mapper. To be called until null before the next
  /// frame is processed, unless it goes ahead. Null if none waits, or, where they may, if they have to go on waiting
  /// for a little while: waiting frames pass faster than the mapper makes keyframes, so one that was asked for is
  /// waited for before the view is left.
  TrackedFrameConstPtr trackWaiting(bool may_hold = true);
  std::size_t waitingFrames() const;
  /// True while all frames that wait have been tracked before, the newest one with success. They need not hold up a
  /// newer frame: it gets a first, provisional result at once and then waits behind them.
  bool goesAhead() const;
  /// True while frames wait that have never been tracked: a newer one has to wait behind them.
  bool catchesUp() const;

  /// Forgets the reference and the prior.
  void reset();

  /// Camera to odom at mid-exposure of the last tracked frame; continuous across references and maps, never rewritten.
  /// Before there is a map, and between maps, it turns with the camera and stays where it is.
  const SE3& T_odom_camera() const;
  /// While lost: camera to odom if it goes on moving as it last did, which nothing measures. Null while not lost.
  std::optional<SE3> predicted_T_odom_camera(std::int64_t mid_exposure_ns) const;
  /// odom to map by the newest reference: T_map_ref T_odom_ref^-1.
  SE3 T_map_odom() const;
  ReferenceConstPtr reference() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mba_vo
