#pragma once

#include <functional>
#include <vector>

#include "mba_vo/mapping/initializer.h"
#include "mba_vo/mapping/mapper_config.h"
#include "mba_vo/tracking/motion_state.h"
#include "mba_vo/tracking/tracker.h"

namespace mba_vo {

/// Velocity of the initial map's reference frame [m/s, rad/s] by the poses next to it in time.
Vector6 referenceVelocity(const InitialMap& initial);

/// Tracks the frames that were buffered before there was a map, in one direction of time from a known frame on.
class Replay {
 public:
  /// `start`: motion at the initial map's reference frame.
  Replay(const MapperConfig& config, const InitialMap& initial, const MotionState& start);

  /// Tracks `frame`; the initial map's own pose of it, if there is one, is the guess.
  TrackedFrame track(const Reference& reference, const FrameConstPtr& frame);
  /// Goes on relative to another reference of the same map.
  void changeReference(const SE3& T_new_old);
  /// Of the last tracked frame, relative to the newest reference.
  const MotionState& motion() const { return motion_; }

 private:
  TrackingGuess guessFor(const FrameConstPtr& frame) const;

  Tracker tracker_;
  double unknown_exposure_;
  const InitialMap& initial_;
  SE3 T_reference_initial_;  // the initial map's reference relative to the present one
  MotionState motion_;
  AffineBrightness brightness_;
};

}  // namespace mba_vo
