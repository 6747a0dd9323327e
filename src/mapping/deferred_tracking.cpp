#include "mba_vo/mapping/deferred_tracking.h"

#include <optional>
#include <utility>

#include "mba_vo/mapping/local_map.h"

namespace mba_vo {
namespace {

constexpr KeyframeId kSettled = 4;  // keyframes after the first: from then on their points have good depths

}  // namespace

void DeferredTracking::begin(const std::shared_ptr<const InitialMap>& initial, const MotionState& start,
                             const std::vector<FrameConstPtr>& frames, std::int64_t until_ns,
                             const ReferenceConstPtr& first_keyframe) {
  const std::int64_t origin_ns = initial->reference->mid_exposure_ns;
  std::deque<FrameConstPtr> before, after;
  for (const FrameConstPtr& frame : frames) {
    if (frame->mid_exposure_ns < origin_ns) before.push_front(frame);
    if (frame->mid_exposure_ns > origin_ns && frame->mid_exposure_ns <= until_ns) after.push_back(frame);
  }
  first_keyframe_ = first_keyframe->id.keyframe_id;
  for (std::deque<FrameConstPtr>* way : {&after, &before}) {
    if (!way->empty()) outward_.emplace_back(config_, initial, start, std::move(*way), first_keyframe);
  }
}

void DeferredTracking::add(const TrackedFrameConstPtr& tracked) {
  if (config_.refine_frames) refinement_.add(tracked);
}

void DeferredTracking::update(const LocalMap& map) {
  refinement_.update(map);
  if (outward_.empty() || !map.has(first_keyframe_) || map.newestKeyframe() > first_keyframe_ + kSettled) return;
  std::vector<ReferenceConstPtr> keyframes;
  for (std::optional<KeyframeId> id = first_keyframe_; id; id = map.keyframeAfter(*id)) {
    keyframes.push_back(map.makeReference(*id));
  }
  for (OutwardTracking& outward : outward_) outward.update(keyframes);
}

void DeferredTracking::reset() {
  outward_.clear();
  refinement_.reset();
}

bool DeferredTracking::doNext(const LocalMap& map, TrajectoryStore& store) {
  if (!outward_.empty() && map.newestKeyframe() >= first_keyframe_ + kSettled) {
    trackOutward(store);
  } else if (!refinement_.done()) {
    refine(map, store);
  } else {
    return false;
  }
  return true;
}

void DeferredTracking::finish(const LocalMap& map, TrajectoryStore& store) {
  while (!outward_.empty()) trackOutward(store);
  refinement_.finish(map);
  while (!refinement_.done()) refine(map, store);
}

void DeferredTracking::trackOutward(TrajectoryStore& store) {
  if (const std::optional<TrackedFrame> tracked = outward_.front().next()) store.addFrame(*tracked);
  if (outward_.front().done()) outward_.pop_front();
}

void DeferredTracking::refine(const LocalMap& map, TrajectoryStore& store) {
  if (const std::optional<TrackedFrame> refined = refinement_.next(map)) store.addFrame(*refined);
}

}  // namespace mba_vo
