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

double Machine::secondsFor(const MapperStep& step) const {
  const MapperOutput& output = step.output;
  double ms = step.kind == MapperStep::Kind::kDeferred ? deferred : 0.0;
  if (output.reference && output.reference->cause == ReferenceCause::kMapBegins) {
    return kSecondsPerMillisecond * first_map;
  }
  if (step.kind == MapperStep::Kind::kFrame) ms += millisecondsForFrame(step);
  if (output.inserted_blur_px) ms += draft + draft_per_px * *output.inserted_blur_px;
  if (output.residuals > 0 && !output.keyframe) ms += iteration + iteration_per_1000 * 1e-3 * output.residuals;
  if (output.keyframe) ms += keyframe;
  return kSecondsPerMillisecond * ms;
}

/// As long as it is no keyframe.
double Machine::millisecondsForFrame(const MapperStep& step) const {
  const TrackedFrame& tracked = *step.cause.tracked;
  if (tracked.status == TrackingStatus::kInitializing) {
    return step.had_time && !step.cause.has_reference ? look_for_map : 0.0;
  }
  if (tracked.status == TrackingStatus::kLost) return tracked.blind ? 0.0 : relocalize;
  return tracked.tracked() && !tracked.provisional && step.had_time ? depth_search : 0.0;
}

Machine Machine::slowedBy(double factor) const {
  Machine slower = *this;
  for (double* time : {&slower.image, &slower.track, &slower.track_per_px, &slower.orientation, &slower.look_for_map,
                       &slower.first_map, &slower.depth_search, &slower.draft, &slower.draft_per_px, &slower.iteration,
                       &slower.iteration_per_1000, &slower.keyframe, &slower.relocalize, &slower.deferred}) {
    *time *= factor;
  }
  return slower;
}

}  // namespace mba_vo
