#include "mba_vo/mapping/deferred_tracking.h"

#include <utility>

namespace mba_vo {

void DeferredTracking::begin(std::shared_ptr<const InitialMap> initial, const MotionState& start,
                             const std::vector<FrameConstPtr>& frames, const ReferenceConstPtr& first_keyframe) {
  backward_.emplace(config_, std::move(initial), start, frames, first_keyframe);
}

void DeferredTracking::add(const TrackedFrameConstPtr& tracked) {
  if (config_.refine_frames) refinement_.add(tracked);
}

void DeferredTracking::update(const LocalMap& map) {
  if (backward_) backward_->update(map);
  refinement_.update(map);
}

void DeferredTracking::reset() {
  backward_.reset();
  refinement_.reset();
}

bool DeferredTracking::doNext(const LocalMap& map, TrajectoryStore& store) {
  if (hasFramesBefore() && backward_->isReady(map)) {
    trackBackwards(store);
  } else if (!refinement_.done()) {
    refine(map, store);
  } else {
    return false;
  }
  return true;
}

void DeferredTracking::finish(const LocalMap& map, TrajectoryStore& store) {
  while (hasFramesBefore()) trackBackwards(store);
  refinement_.finish(map);
  while (!refinement_.done()) refine(map, store);
}

void DeferredTracking::trackBackwards(TrajectoryStore& store) {
  const TrackedFrame tracked = backward_->next();
  if (tracked.tracked()) store.addFrame(tracked);
}

void DeferredTracking::refine(const LocalMap& map, TrajectoryStore& store) {
  if (const std::optional<TrackedFrame> refined = refinement_.next(map)) store.addFrame(*refined);
}

}  // namespace mba_vo
