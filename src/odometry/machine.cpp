#include "mba_vo/odometry/machine.h"

namespace mba_vo {
namespace {

constexpr double kSecondsPerMillisecond = 1e-3;

}  // namespace

double Machine::secondsFor(const TrackerStep& step) const {
  double ms = step.kind == TrackerStep::Kind::kImage ? image : 0.0;
  const TrackedFrameConstPtr& tracked = step.message.tracked;
  if (tracked) {
    const bool aligned = tracked->tracked() || (tracked->status == TrackingStatus::kLost && !tracked->blind);
    if (aligned) ms += track + track_per_px * tracked->measures.blur_length_px;
    if (tracked->orientation_only) ms += orientation;
  }
  return kSecondsPerMillisecond * ms;
}

Machine::MapperSeconds Machine::secondsFor(const MapperStep& step) const {
  if (step.kind == MapperStep::Kind::kDeferred) return {0.0, kSecondsPerMillisecond * deferred};
  if (step.kind != MapperStep::Kind::kFrame) return {};
  if (step.output.reference && step.output.reference->cause == ReferenceCause::kMapBegins) {
    return {0.0, kSecondsPerMillisecond * first_map};
  }
  MapperSeconds seconds;
  const TrackedFrame& tracked = *step.cause.tracked;
  double ms = 0.0;
  if (tracked.status == TrackingStatus::kInitializing) {
    if (step.had_time && !step.cause.has_reference) ms += look_for_map;
  } else if (tracked.status == TrackingStatus::kLost && !tracked.blind) {
    ms += relocalize;
  } else if (tracked.tracked() && !tracked.provisional) {
    if (step.had_time) ms += depth_search;
  }
  if (step.output.keyframe) {
    ms += draft + draft_per_px * step.output.keyframe->blur_length_px;
    seconds.draft = kSecondsPerMillisecond * ms;
    ms += keyframe + keyframe_per_1000 * 1e-3 * step.output.keyframe->residuals;
  }
  seconds.total = kSecondsPerMillisecond * ms;
  return seconds;
}

Machine Machine::slowedBy(double factor) const {
  Machine slower = *this;
  for (double* time : {&slower.image, &slower.track, &slower.track_per_px, &slower.orientation, &slower.look_for_map,
                       &slower.first_map, &slower.depth_search, &slower.draft, &slower.draft_per_px, &slower.keyframe,
                       &slower.keyframe_per_1000, &slower.relocalize, &slower.deferred}) {
    *time *= factor;
  }
  return slower;
}

}  // namespace mba_vo
