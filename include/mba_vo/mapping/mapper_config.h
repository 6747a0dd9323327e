#pragma once

#include "mba_vo/deblur/deblur_queue.h"
#include "mba_vo/deblur/deblurrer.h"
#include "mba_vo/depth_search/depth_search.h"
#include "mba_vo/geometry/calibration_correction.h"
#include "mba_vo/initialization/initializer.h"
#include "mba_vo/mapping/map_health.h"
#include "mba_vo/pose_graph/loop_closer.h"
#include "mba_vo/relocalization/relocalizer.h"
#include "mba_vo/tracking/keyframe_policy.h"
#include "mba_vo/tracking/tracker.h"
#include "mba_vo/window/window.h"

namespace mba_vo {

/// Options of the mapper. `describe` names every option once, for YAML, ROS parameters and documentation.
struct MapperConfig {
  InitializerConfig initializer;
  DepthSensorConfig depth_sensor;
  DepthSearchConfig depth_search;
  WindowConfig window;
  DeblurConfig deblur;
  DeblurQueueConfig deblur_queue;
  // The tracker's own options, for the frames that are tracked again after initialisation. Not read from `mapper`.
  TrackerConfig tracker;
  KeyframePolicyConfig keyframe;
  int new_points_per_keyframe = 1500;
  int max_display_points = 50000;
  double restart_after_lost = 1.0;
  MapHealthConfig health;
  RelocalizerConfig relocalizer;
  LoopConfig loops;
  bool commute_blur = true;
  bool refine_calibration = true;
  bool refine_frames = true;
  bool localize_only = false;
  bool vignette_told = false;  // by a file: no vignette is to be found. Not read from `mapper`
  bool deterministic = false;  // bit-identical results run after run; sums in a fixed order

  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    v.section("initializer", c.initializer);
    v.section("depth_sensor", c.depth_sensor);
    v.section("depth_search", c.depth_search);
    v.section("window", c.window);
    v.section("deblur", c.deblur);
    v.section("deblur_queue", c.deblur_queue);
    v("new_points_per_keyframe", c.new_points_per_keyframe, 50, 10000, "candidate points selected in a new keyframe");
    v("max_display_points", c.max_display_points, 0, 10000000, "old map points kept for display");
    v("restart_after_lost", c.restart_after_lost, 0.05, 1e6,
      "a new map is begun after being lost for so long with images that show something [s]");
    v.section("health", c.health);
    v.section("relocalizer", c.relocalizer);
    v.section("loops", c.loops);
    v("commute_blur", c.commute_blur, "blur frames along the keyframe's own path where the keyframe is not sharp");
    v("refine_calibration", c.refine_calibration,
      "correct vignette, focal length, centre, radial distortion and row time where the images say that they are "
      "wrong");
    v("refine_frames", c.refine_frames,
      "track frames once more, for the trajectory, when a second keyframe after them has been optimised");
    v("localize_only", c.localize_only,
      "a map that was loaded stays as it is: the camera is looked for in it until it is found, and nothing new is "
      "kept");
  }
};

}  // namespace mba_vo
