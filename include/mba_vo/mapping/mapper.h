#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "mba_vo/mapping/keyframe_deblurring.h"
#include "mba_vo/mapping/keyframe_report.h"
#include "mba_vo/mapping/local_map.h"
#include "mba_vo/mapping/loop_closing.h"
#include "mba_vo/mapping/mapper_config.h"
#include "mba_vo/mapping/mapping_phase.h"
#include "mba_vo/relocalization/saved_map.h"
#include "mba_vo/tracking/tracked_frame.h"
#include "mba_vo/trajectory/trajectory_store.h"

namespace mba_vo {

/// What one call of Mapper::process or Mapper::refine produced.
struct MapperOutput {
  ReferenceConstPtr reference;                  // new snapshot for the tracker, or null
  bool inserted = false;                        // a keyframe: the reference is a draft of it
  bool refinement = false;                      // a piece of that of a keyframe: it is of no frame
  bool searched = false;                        // for a frame that the tracker lost, among the keyframes
  bool searched_depths = false;                 // in the frame
  int initial_frames = 0;                       // of those that the map was made of: tracked, depths searched in them
  int residuals = 0;                            // that the optimisation, or what it was instead, went through
  std::optional<KeyframeReport> keyframe;       // set if one has been refined, or had to do with what there was
  std::optional<SharpKeyframe> sharp_keyframe;  // set if one has been deblurred
  std::string message;                          // what happened, for the log and the status; may be empty
  bool is_news = false;                         // the message is to be told at once

  /// The reference is the first of a map.
  bool beginsMap() const { return reference && reference->cause == ReferenceCause::kMapBegins; }
};

/// Takes every TrackedFrame, initialises the map, refines depths, inserts keyframes, optimises the window and owns the
/// trajectory store. Not thread-safe: one thread calls it.
class Mapper {
 public:
  /// `deblurrer`: in place of the one that the configuration names.
  explicit Mapper(const MapperConfig& config, std::shared_ptr<const Deblurrer> deblurrer = nullptr);
  ~Mapper();
  Mapper(const Mapper&) = delete;
  Mapper& operator=(const Mapper&) = delete;

  /// Without time to spare, because other frames wait, it leaves out what others may do as well: to look for a first
  /// map in this frame, or for depths, or for where the camera was when it was lost. A keyframe that it inserts is of
  /// use at once: the reference in the output is a snapshot of it, a draft. It waits for refine(), which may be called
  /// between frames, or after them. When the view is being left, the next one is inserted before that is done.
  MapperOutput process(const TrackedFrameConstPtr& frame, bool has_time = true);
  /// Whether there is a keyframe to be refined, or one to be inserted that waited for this, as a map's second one may.
  bool needsRefinement() const;
  /// Does a piece of it: an iteration of the window's optimisation. After the last one, the output has the better
  /// snapshot of the keyframe. At the beginning of a map, the frames that it was made of are followed first.
  MapperOutput refine();

  /// Whether anybody looks at sharp keyframes: only then are those made that are not for the map.
  void watchSharpKeyframes(bool watched);

  /// Does a piece of what can wait for a free moment: tracks one frame that came before the map's first keyframe. False
  /// if there is nothing to do, or not yet.
  bool doDeferredWork();

  /// What becomes of the next frame.
  MappingPhase phase() const;
  /// The current snapshot, null before initialisation: for a tracker that was restarted.
  ReferenceConstPtr currentReference() const;

  /// The map as it is now, its poses corrected by loops, for which it waits as smoothedTrajectory() does; nullopt if
  /// there is none. A map that was loaded keeps its unit of length.
  std::optional<SavedMap> savedMap() const;
  /// Begins anew in a map of an earlier run, whose keyframes lie before this one (moveBeforeAnyRun). The camera is
  /// looked for in it, and the map goes on from there in its frame and unit of length, with a map id of its own each
  /// time. Where the camera is not found for ten seconds, or what is found there turns out wrong at once, another map
  /// begins; not so with MapperConfig::localize_only. reset() begins in it again. Throws std::invalid_argument if the
  /// map has no keyframe.
  void beginIn(const SavedMap& map);

  /// Forgets the map; the trajectory store keeps the poses found so far, with all that had been put off. The next map
  /// gets a new map id.
  void reset();
  /// The same, but what had been put off stays undone: after something has gone wrong.
  void abandonMap();

  /// How the calibration is to be corrected, by what the images say; nullopt before the first frame.
  std::optional<CalibrationCorrection> correction() const;
  /// The last such correction that the images left as it is for a while; nullopt if there was none.
  std::optional<CalibrationCorrection> settledCorrection() const;

  /// All frames with a measured pose, by time, each re-expressed with its keyframe's newest pose, as the loops known by
  /// now have it.
  std::vector<TrajectoryEntry> trajectory() const;
  /// The same as if all that was put off had been done, and loops closed; nothing has, and the map goes on as if nobody
  /// had asked.
  SmoothedTrajectory smoothedTrajectory() const;
  std::vector<TrajectoryEntry> finishedTrajectory() const { return smoothedTrajectory().entries; }
  /// Points of the active window and, up to MapperConfig::max_display_points, of marginalised keyframes.
  std::vector<MapPoint> points() const;
  /// What became of the keyframes that were to be deblurred, in all maps.
  DeblurCounts deblurCounts() const;
  /// What has come of the search for loops, without waiting for what is under way.
  LoopCounts loopCounts() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mba_vo
