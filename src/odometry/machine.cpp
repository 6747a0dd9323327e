#include "mba_vo/odometry/machine.h"

namespace mba_vo {
namespace {

constexpr double kSecondsPerMillisecond = 1e-3;
// Of the time of one core that two can share: machine.yaml of one core against that of two, medians over desk, shake,
// kitchen and spin; of new points, activation_ms of keyframes.csv of spin. All else took as long with two.
constexpr double kParallelSearch = 0.86;
constexpr double kParallelOptimisation = 0.7;
constexpr double kParallelActivation = 0.8;
constexpr double kFailedLeap = 2.0;  // alignments: desk on one core, 28 ms where a frame took 13

double thousands(const MapperOutput& output) { return 1e-3 * output.residuals; }

}  // namespace

double Machine::secondsFor(const TrackerStep& step) const {
  double ms = step.kind == TrackerStep::Kind::kImage ? image : 0.0;
  if (step.failed_leap) ms += kFailedLeap * track;
  const TrackedFrameConstPtr& tracked = step.message.tracked;
  if (tracked) {
    const bool aligned = tracked->tracked() || (tracked->status == TrackingStatus::kLost && !tracked->blind);
    if (aligned) ms += track + track_per_px * tracked->measures.blur_length_px;
    if (tracked->orientation_only || tracked->predicted) ms += orientation;
  }
  return kSecondsPerMillisecond * ms;
}

StepTime Machine::timeFor(const MapperStep& step) const {
  const MapperOutput& output = step.output;
  double serial = 0.0, search = 0.0, optimisation = 0.0, activation = 0.0;  // [ms]
  switch (step.kind) {
    case MapperStep::Kind::kDeferred:
      serial = deferred;
      break;
    case MapperStep::Kind::kFrame:
      serial = millisecondsWithoutMap(step);
      if (output.searched_depths) search = depth_search;
      break;
    case MapperStep::Kind::kRefinement:
      if (output.residuals > 0 && !output.keyframe && !output.inserted) {
        optimisation = iteration + iteration_per_1000 * thousands(output);
      }
      serial += output.initial_frames * track;
      search += output.initial_frames * depth_search;
      break;
    case MapperStep::Kind::kPassed:
      break;
  }
  if (output.inserted) {
    serial += draft;
    activation = draft_per_1000 * thousands(output);
  }
  if (output.keyframe) serial += keyframe;
  const double parallel =
      kParallelSearch * search + kParallelOptimisation * optimisation + kParallelActivation * activation;
  serial += search + optimisation + activation - parallel;
  return {kSecondsPerMillisecond * serial, kSecondsPerMillisecond * parallel};
}

/// For a first map, or for a camera that is lost.
double Machine::millisecondsWithoutMap(const MapperStep& step) const {
  const TrackedFrame& tracked = *step.cause.tracked;
  if (step.output.searched) return relocalize;
  if (tracked.status != TrackingStatus::kInitializing || !step.had_time || step.cause.has_reference) return 0.0;
  const double attempt = look_for_map + look_for_map_per_1000 * thousands(step.output);
  return step.output.beginsMap() ? attempt + first_map : attempt;
}

Machine Machine::slowedBy(double factor) const {
  Machine slower = *this;
  for (double* time :
       {&slower.image, &slower.track, &slower.track_per_px, &slower.orientation, &slower.look_for_map,
        &slower.look_for_map_per_1000, &slower.first_map, &slower.depth_search, &slower.draft, &slower.draft_per_1000,
        &slower.iteration, &slower.iteration_per_1000, &slower.keyframe, &slower.relocalize, &slower.deferred}) {
    *time *= factor;
  }
  return slower;
}

}  // namespace mba_vo
