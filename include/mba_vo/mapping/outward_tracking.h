#pragma once

#include <deque>
#include <memory>

#include "mba_vo/initialization/initializer.h"
#include "mba_vo/mapping/mapper_config.h"
#include "mba_vo/tracking/motion_state.h"
#include "mba_vo/tracking/reference.h"
#include "mba_vo/tracking/tracker.h"

namespace mba_vo {

class LocalMap;

/// Velocity of the initial map's reference frame [m/s, rad/s] by the poses next to it in time.
BodyMotion referenceMotion(const InitialMap& initial);

/// Where the newest frame is whose pose the initial map knows: that of the reference itself, `start`, if there is none
/// after it.
TrackingHint newestOf(const InitialMap& initial, const ExposureTrajectory& start);

/// The reference's own frame as the tracker would report it.
TrackedFrameConstPtr referenceItself(const Reference& reference, const FrameConstPtr& frame,
                                     const ExposureTrajectory& trajectory);

/// Tracks frames against a map's first keyframe, one after the other away from it in time, backwards or forwards. Ends
/// with the first one that is lost: beyond it there is nothing to predict from, and what seems to fit is seldom right.
/// From the first one that is DEGRADED on, all are.
class OutwardTracking {
 public:
  /// `start`: motion at the initial map's reference frame. `frames`: in the order in which they are to be tracked,
  /// against `first_keyframe`, a snapshot about it.
  OutwardTracking(const MapperConfig& config, std::shared_ptr<const InitialMap> initial, const MotionState& start,
                  std::deque<FrameConstPtr> frames, ReferenceConstPtr first_keyframe);

  bool done() const { return frames_.empty(); }
  /// False as long as the first keyframe's points have no good depths: it is better to wait.
  bool isReady(const LocalMap& map) const;
  /// The map has a new keyframe. While the first one is in the window, its points get better.
  void update(const LocalMap& map);
  /// Tracks the next frame, ready or not. The initial map's own pose of the frame, if there is one, is the guess.
  TrackedFrame next();

 private:
  TrackingGuess guessFor(const Frame& frame) const;

  Tracker tracker_;
  double unknown_exposure_;  // [s]
  std::shared_ptr<const InitialMap> initial_;
  std::deque<FrameConstPtr> frames_;  // still to be tracked
  ReferenceConstPtr first_keyframe_;
  MotionState motion_;
  AffineBrightness brightness_;
  bool seen_badly_ = false;  // the last frame was DEGRADED
};

}  // namespace mba_vo
