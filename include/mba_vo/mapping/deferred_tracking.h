#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "mba_vo/mapping/backward_tracking.h"
#include "mba_vo/mapping/frame_refinement.h"
#include "mba_vo/trajectory/trajectory_store.h"

namespace mba_vo {

/// What is tracked for the trajectory alone, and can wait for a free moment: the frames that came before the map, and
/// those between keyframes once more.
class DeferredTracking {
 public:
  explicit DeferredTracking(const MapperConfig& config) : config_(config), refinement_(config) {}

  /// A map begins; see BackwardTracking.
  void begin(std::shared_ptr<const InitialMap> initial, const MotionState& start,
             const std::vector<FrameConstPtr>& frames, const ReferenceConstPtr& first_keyframe);
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
  bool hasFramesBefore() const { return backward_ && !backward_->done(); }
  void trackBackwards(TrajectoryStore& store);
  void refine(const LocalMap& map, TrajectoryStore& store);

  MapperConfig config_;
  std::optional<BackwardTracking> backward_;
  FrameRefinement refinement_;
};

}  // namespace mba_vo
