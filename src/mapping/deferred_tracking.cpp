#include "mba_vo/mapping/deferred_tracking.h"

#include <utility>

namespace mba_vo {

void DeferredTracking::begin(const std::shared_ptr<const InitialMap>& initial, const MotionState& start,
                             const std::vector<FrameConstPtr>& frames, std::int64_t until_ns,
                             const ReferenceConstPtr& first_keyframe) {
  const std::int64_t origin_ns = initial->reference->mid_exposure_ns;
  std::deque<FrameConstPtr> before, after;
  for (const FrameConstPtr& frame : frames) {
    if (frame->mid_exposure_ns < origin_ns) before.push_front(frame);
    if (frame->mid_exposure_ns > origin_ns && frame->mid_exposure_ns <= until_ns) after.push_back(frame);
  }
  backward_.emplace(config_, initial, start, std::move(before), first_keyframe);
  forward_.emplace(config_, initial, start, std::move(after), first_keyframe);
}

void DeferredTracking::add(const TrackedFrameConstPtr& tracked) {
  if (config_.refine_frames) refinement_.add(tracked);
}

void DeferredTracking::update(const LocalMap& map) {
  if (backward_) backward_->update(map);
  if (forward_) forward_->update(map);
  refinement_.update(map);
}

void DeferredTracking::reset() {
  backward_.reset();
  forward_.reset();
  refinement_.reset();
}

OutwardTracking* DeferredTracking::outward() {
  if (forward_ && !forward_->done()) return &*forward_;
  if (backward_ && !backward_->done()) return &*backward_;
  return nullptr;
}

bool DeferredTracking::doNext(const LocalMap& map, TrajectoryStore& store) {
  OutwardTracking* const next = outward();
  if (next && next->isReady(map)) {
    track(*next, store);
  } else if (!refinement_.done()) {
    refine(map, store);
  } else {
    return false;
  }
  return true;
}

void DeferredTracking::finish(const LocalMap& map, TrajectoryStore& store) {
  while (OutwardTracking* const next = outward()) track(*next, store);
  refinement_.finish(map);
  while (!refinement_.done()) refine(map, store);
}

void DeferredTracking::track(OutwardTracking& outward, TrajectoryStore& store) {
  const TrackedFrame tracked = outward.next();
  if (tracked.tracked()) store.addFrame(tracked);
}

void DeferredTracking::refine(const LocalMap& map, TrajectoryStore& store) {
  if (const std::optional<TrackedFrame> refined = refinement_.next(map)) store.addFrame(*refined);
}

}  // namespace mba_vo
