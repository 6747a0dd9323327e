#pragma once

#include "mba_vo/odometry/mapper_pipeline.h"
#include "mba_vo/odometry/tracker_pipeline.h"

namespace mba_vo {

/// How long the steps of the pipeline take on a machine. Times are those of one core [ms]. What decides about a step's
/// time is counted, not measured, so that the same run always takes the same time. The defaults are those of a core of
/// 2.1 GHz: medians of machine.yaml of `taskset --cpu-list 0 mba_vo_offline` over desk, shake, kitchen and spin, the
/// other core busy as it is in live runs. That of `relocalize` is a guess: nothing was lost there.
struct Machine {
  double cores = 2.0;              // that can be used at a time
  double image = 0.3;              // a frame is made of an image
  double track = 6.8;              // a sharp frame is aligned
  double track_per_px = 0.1;       // and for each pixel of its blur
  double orientation = 10.0;       // the rotation of a frame is measured while there is no map
  double look_for_map = 23.0;      // the initialiser takes in a frame
  double first_map = 180.0;        // and makes a map, with its second keyframe
  double depth_search = 3.9;       // depths are searched in a frame
  double draft = 14.0;             // a sharp keyframe is inserted, until its draft is sent
  double draft_per_px = 0.5;       // and for each pixel of its blur
  double keyframe = 21.0;          // the window is optimised with it
  double keyframe_per_1000 = 4.9;  // and for each thousand residuals
  double relocalize = 12.0;        // a lost frame is looked for
  double deferred = 4.6;           // a frame is tracked once more for the trajectory

  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    v("cores", c.cores, 0.1, 1024.0, "cores that can be used at a time");
    v("image", c.image, 0.0, 1e4, "a frame is made of an image [ms]");
    v("track", c.track, 0.0, 1e4, "a sharp frame is aligned [ms]");
    v("track_per_px", c.track_per_px, 0.0, 1e4, "and for each pixel of its blur [ms]");
    v("orientation", c.orientation, 0.0, 1e4, "the rotation of a frame is measured while there is no map [ms]");
    v("look_for_map", c.look_for_map, 0.0, 1e4, "the initialiser takes in a frame [ms]");
    v("first_map", c.first_map, 0.0, 1e5, "and makes a map [ms]");
    v("depth_search", c.depth_search, 0.0, 1e4, "depths are searched in a frame [ms]");
    v("draft", c.draft, 0.0, 1e4, "a sharp keyframe is inserted, until its draft is sent [ms]");
    v("draft_per_px", c.draft_per_px, 0.0, 1e4, "and for each pixel of its blur [ms]");
    v("keyframe", c.keyframe, 0.0, 1e4, "the window is optimised with it [ms]");
    v("keyframe_per_1000", c.keyframe_per_1000, 0.0, 1e4, "and for each thousand residuals [ms]");
    v("relocalize", c.relocalize, 0.0, 1e4, "a lost frame is looked for [ms]");
    v("deferred", c.deferred, 0.0, 1e4, "a frame is tracked once more for the trajectory [ms]");
  }

  /// [s], of one core.
  double secondsFor(const TrackerStep& step) const;
  /// [s], of one core, until the draft of a new keyframe is sent, 0 if none is, and in all.
  struct MapperSeconds {
    double draft = 0.0;
    double total = 0.0;
  };
  MapperSeconds secondsFor(const MapperStep& step) const;
  /// The same machine with all times multiplied.
  Machine slowedBy(double factor) const;
};

}  // namespace mba_vo
