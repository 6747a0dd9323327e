#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "mba_vo/initialization/initializer.h"
#include "mba_vo/mapping/mapper_config.h"
#include "mba_vo/tracking/motion_state.h"
#include "mba_vo/tracking/reference.h"
#include "mba_vo/tracking/tracker.h"

namespace mba_vo {

/// Where the newest frame is whose pose the initial map knows: that of the reference itself, `start`, if there is none
/// after it.
TrackingHint newestOf(const InitialMap& initial, const ExposureTrajectory& start);

/// The reference's own frame as the tracker would report it.
TrackedFrameConstPtr referenceItself(const Reference& reference, const FrameConstPtr& frame,
                                     const ExposureTrajectory& trajectory);

/// Of a frame with this pose, those beyond it can be tracked.
bool isSeenWell(const TrackedFrame& tracked);

/// Tracks frames one after the other away from a map's first keyframe in time, backwards or forwards, against that of
/// the map's first keyframes by which a pose is known best: on a fast turn the first one is soon out of sight. Ends
/// with the first frame that is seen badly, or not at all: beyond it there is nothing to predict from, poses slide, and
/// what seems to fit is seldom right (docs/decisions/2026-11-29-before-the-map.md).
class OutwardTracking {
 public:
  /// `start`: motion at the initial map's reference frame. `frames`: in the order in which they are to be tracked,
  /// against `first_keyframe`, a snapshot about it, until there are others.
  OutwardTracking(const MapperConfig& config, std::shared_ptr<const InitialMap> initial, const MotionState& start,
                  std::deque<FrameConstPtr> frames, const ReferenceConstPtr& first_keyframe);

  bool done() const { return frames_.empty(); }
  /// Snapshots, at one moment, of the first keyframe and those after it in the window: more of them, with better
  /// points.
  void update(const std::vector<ReferenceConstPtr>& keyframes);
  /// Tracks the next frame, from the initial map's own pose of it if there is one; nullopt: it ends here.
  std::optional<TrackedFrame> next();

 private:
  /// In the axes of that keyframe.
  TrackingGuess guessFor(const Frame& frame, const Reference& keyframe) const;
  /// The keyframe that shows most of what a frame sees from there.
  ReferenceConstPtr nearestTo(const SE3& T_map_camera) const;
  /// By the keyframe of the frame before, or from now on by the nearest one.
  TrackedFrame track(const FrameConstPtr& frame);

  Tracker tracker_;
  KeyframePolicy policy_;
  double unknown_exposure_;  // [s]
  std::shared_ptr<const InitialMap> initial_;
  std::deque<FrameConstPtr> frames_;                   // still to be tracked
  std::map<KeyframeId, ReferenceConstPtr> keyframes_;  // from the map's first one on
  KeyframeId keyframe_;                                // of the last frame
  MotionState motion_;                                 // there, relative to that keyframe
  AffineBrightness brightness_;
};

}  // namespace mba_vo
