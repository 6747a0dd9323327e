#pragma once

#include "mba_vo/odometry/mapper_pipeline.h"
#include "mba_vo/odometry/tracker_pipeline.h"

namespace mba_vo {

/// What a step of the mapper takes of one core: first what one thread does, then what all cores can share [s].
struct StepTime {
  double serial = 0.0;
  double parallel = 0.0;
  double sum() const { return serial + parallel; }
};

/// How long the steps of the pipeline take on a machine. Times are those of one core [ms]. What decides about a step's
/// time is counted, not measured, so that the same run always takes the same time. The defaults are those of a core of
/// 2.1 GHz: medians of machine.yaml of `taskset --cpu-list 0 mba_vo_offline` over desk, shake, kitchen and spin, the
/// other core busy as it is in live runs, rounded. `relocalize` is of live runs of spin, and `look_for_map_per_1000` of
/// kitchen: elsewhere too few frames were lost, or tries made; in kitchen pieces of the optimisation took equally long,
/// and are not counted. `draft`, `iteration`, `keyframe` and `first_map` follow the code: what they were, times the
/// ratio of two programs on another machine (docs/decisions/2026-11-29-point-budget.md, 2026-11-29-first-pose.md).
struct Machine {
  double cores = 2.0;                  // that can be used at a time
  double image = 1.3;                  // a frame is made of an image
  double track = 7.5;                  // a sharp frame is aligned
  double track_per_px = 0.08;          // and for each pixel of its blur
  double orientation = 7.8;            // the rotation of a frame is measured while there is no map
  double look_for_map = 16.0;          // the initialiser takes in a frame
  double look_for_map_per_1000 = 6.7;  // and for each thousand residuals of structure and motion
  double first_map = 20.0;             // and makes a map
  double depth_search = 4.4;           // depths are searched in a frame
  double draft = 4.5;                  // a keyframe is inserted
  double draft_per_1000 = 1.4;         // and for each thousand residuals of new points
  double iteration = 5.5;              // a piece of the optimisation of the window
  double iteration_per_1000 = 1.5;     // and for each thousand residuals that it evaluates
  double keyframe = 4.1;               // the last piece of what is done with a keyframe
  double relocalize = 23.0;            // a lost frame is looked for
  double deferred = 4.0;               // a frame is tracked once more for the trajectory

  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    v("cores", c.cores, 0.1, 1024.0, "cores that can be used at a time");
    v("image", c.image, 0.0, 1e4, "a frame is made of an image [ms]");
    v("track", c.track, 0.0, 1e4, "a sharp frame is aligned [ms]");
    v("track_per_px", c.track_per_px, 0.0, 1e4, "and for each pixel of its blur [ms]");
    v("orientation", c.orientation, 0.0, 1e4, "the rotation of a frame is measured while there is no map [ms]");
    v("look_for_map", c.look_for_map, 0.0, 1e4, "the initialiser takes in a frame [ms]");
    v("look_for_map_per_1000", c.look_for_map_per_1000, 0.0, 1e4,
      "and for each thousand residuals of structure and motion [ms]");
    v("first_map", c.first_map, 0.0, 1e5, "and makes a map [ms]");
    v("depth_search", c.depth_search, 0.0, 1e4, "depths are searched in a frame [ms]");
    v("draft", c.draft, 0.0, 1e4, "a keyframe is inserted [ms]");
    v("draft_per_1000", c.draft_per_1000, 0.0, 1e4, "and for each thousand residuals of new points [ms]");
    v("iteration", c.iteration, 0.0, 1e4, "a piece of the optimisation of the window [ms]");
    v("iteration_per_1000", c.iteration_per_1000, 0.0, 1e4, "and for each thousand residuals [ms]");
    v("keyframe", c.keyframe, 0.0, 1e4, "the last piece of what is done with a keyframe [ms]");
    v("relocalize", c.relocalize, 0.0, 1e4, "a lost frame is looked for [ms]");
    v("deferred", c.deferred, 0.0, 1e4, "a frame is tracked once more for the trajectory [ms]");
  }

  /// [s], of one core.
  double secondsFor(const TrackerStep& step) const;
  StepTime timeFor(const MapperStep& step) const;
  /// The same machine with all times multiplied.
  Machine slowedBy(double factor) const;

 private:
  double millisecondsWithoutMap(const MapperStep& step) const;
};

}  // namespace mba_vo
