#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "mba_vo/mapping/frame_refinement.h"
#include "mba_vo/mapping/outward_tracking.h"
#include "mba_vo/trajectory/trajectory_store.h"

namespace mba_vo {

/// What is tracked for the trajectory alone, and can wait for a free moment: the frames that came before the map, and
/// those between keyframes once more.
class DeferredTracking {
 public:
  explicit DeferredTracking(const MapperConfig& config) : config_(config), refinement_(config) {}

  /// A map begins: of `frames` (by time), those up to `until_ns` are tracked from its first keyframe on.
  void begin(const std::shared_ptr<const InitialMap>& initial, const MotionState& start,
             const std::vector<FrameConstPtr>& frames, std::int64_t until_ns, const ReferenceConstPtr& first_keyframe);
  /// The map has taken in a frame, or one of them once more.
  void add(const TrackedFrameConstPtr& tracked);
  /// The window has been optimised with a new keyframe.
  void update(const LocalMap& map);
  void reset();

  /// Tracks one frame. False if there is nothing to do, or not yet.
  bool doNext(const LocalMap& map, TrajectoryStore& store);
  /// Tracks all, ready or not.
  void finish(const LocalMap& map, TrajectoryStore& store);

 private:
  void trackOutward(TrajectoryStore& store);
  void refine(const LocalMap& map, TrajectoryStore& store);

  MapperConfig config_;
  KeyframeId first_keyframe_ = 0;        // of the map
  std::deque<OutwardTracking> outward_;  // the frames after it that the tracker has not looked at, then those before it
  FrameRefinement refinement_;
};

}  // namespace mba_vo
