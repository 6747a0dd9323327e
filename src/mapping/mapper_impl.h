#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mba_vo/mapping/deferred_tracking.h"
#include "mba_vo/mapping/keyframe_selector.h"
#include "mba_vo/mapping/mapper.h"
#include "mba_vo/mapping/mapping_phase.h"
#include "mba_vo/mapping/recovery.h"
#include "mba_vo/relocalization/saved_map.h"

namespace mba_vo {

/// The way of a frame through the mapper is in mapper.cpp; how a map begins, is lost, found again and given up in
/// map_life.cpp; how it is found in a map of an earlier run, and kept for a later one, in earlier_map.cpp.
class Mapper::Impl {
 public:
  Impl(const MapperConfig& config, std::shared_ptr<const Deblurrer> deblurrer);

  MapperOutput process(const TrackedFrameConstPtr& frame, bool has_time);
  bool needsRefinement() const { return initial_ || phase_ == MappingPhase::kRefining || selector_.hasReady(); }
  MapperOutput refine();
  void watchSharpKeyframes(bool watched) { deblurring_.setWatched(watched); }
  bool doDeferredWork() { return map_ && deferred_.doNext(*map_, store_); }
  SmoothedTrajectory smoothedTrajectory() const;
  void reset();
  void abandonMap();
  void beginIn(const SavedMap& map);
  std::optional<SavedMap> savedMap() const;
  /// The present map, with keyframes where loops have put them; nullopt if none is kept.
  std::optional<SavedMap> mapAsCorrected(const TrajectoryStore::CorrectedKeyframes& corrected) const;

  MappingPhase phase() const { return phase_; }
  ReferenceConstPtr currentReference() const { return reference_; }
  std::optional<CalibrationCorrection> correction() const {
    return calibration_ ? std::optional(calibration_->correction()) : std::nullopt;
  }
  std::optional<CalibrationCorrection> settledCorrection() const {
    return calibration_ ? calibration_->settled() : std::nullopt;
  }
  std::vector<TrajectoryEntry> trajectory() const;
  std::vector<MapPoint> points() const;
  DeblurCounts deblurCounts() const { return deblurring_.counts(); }
  LoopCounts loopCounts() const { return loops_.counts(); }

 private:
  void change(MappingEvent event) { phase_ = nextPhase(mappingTable(), phase_, event); }
  /// A frame that is no newer than the last one was tracked again: its pose is better now, the map has it already.
  MapperOutput revise(const TrackedFrameConstPtr& frame);
  /// The tracker is given the sharp image if it is using the blurred one.
  void takeSharpKeyframe(MapperOutput& output);
  /// Returns it, or the one before, if it is to become a keyframe now.
  TrackedFrameConstPtr integrate(const TrackedFrameConstPtr& frame, bool has_time);
  void insertKeyframe(const TrackedFrameConstPtr& chosen, const BodyMotion& motion, MapperOutput& output);
  /// The keyframe that is being refined has to do with what there is.
  void refineNoFurther(MapperOutput& output);
  void finishRefining(bool refined, MapperOutput& output);
  /// The window has been refined with its newest keyframe, made of `chosen`, or would have been.
  /// What loops have done to the map, or nothing, is returned.
  std::string complete(KeyframeReport& report, const TrackedFrameConstPtr& chosen, bool refined);
  /// The newest keyframe, made of this frame.
  void deblur(const FrameConstPtr& frame, const Vector6& acceleration = Vector6::Zero(),
              const std::optional<Vector6>& measured_velocity = std::nullopt);
  /// Of a keyframe in the window, for the tracker.
  std::shared_ptr<Reference> snapshot(ReferenceCause cause, KeyframeId keyframe, const std::string& doubt = {});

  MapperOutput findMap(const TrackedFrame& frame, bool has_time);
  bool isKnownWithoutMap(const Frame& frame);
  /// Looks for the camera in the map of an earlier run, for a while, or for ever where only that counts.
  MapperOutput locate(const TrackedFrame& frame);
  void lookInEarlierMap();
  MapperOutput notFoundInEarlierMap(const std::string& reason);
  /// What the window in which the camera was found continues.
  LocalMap::Identity identityOfEarlierMap();
  /// The map is the earlier one, and stays as it was then.
  bool keepsEarlierMap() const { return earlier_ && config_.localize_only; }

  MapperOutput initialize(const FrameConstPtr& frame);
  void beginCalibration(const CalibrationCorrection& known);
  /// What the first map says of the shutter: its frames are read so, and those that come will be.
  void adoptRowTime(InitialMap& initial);
  void adoptExposure(InitialMap& initial);
  /// The first reference, with a hint about the newest frame whose pose the initialiser knows: the tracker goes on from
  /// there. Those that came before are tracked, for the trajectory, when there is time.
  void begin(std::shared_ptr<const InitialMap> initial, const BodyMotion& motion);
  /// Frames that the map was made of tell more of its depths, and where the camera was with the newest of them is the
  /// second keyframe, if it had moved on since the reference. Not what the tracker waits for.
  MapperOutput goAlong();
  /// The map is wrong. Its last poses are forgotten, all of them if it has only just begun; the tracker is told to
  /// leave it. What a young map was made of may hold a better one.
  MapperOutput giveUp(MapperOutput output);
  MapperOutput handleLost(const TrackedFrame& frame, bool has_time);
  /// The camera was found by a keyframe. If that has left the window, a new window begins with it.
  MapperOutput goOnFrom(const Relocalizer::Found& found, MapperOutput output);
  /// A tracker that goes on without a reference while there is a map was restarted; it is given the current one.
  MapperOutput resend();
  static MapperOutput stale(const TrackedFrame& frame);
  /// Tells the tracker to leave the map.
  std::shared_ptr<Reference> closed(const std::string& reason) const;
  /// Back to the search for a first map. The poses found so far stay, and so does what is known of the calibration.
  void forgetMap();

  MapperConfig config_;
  MappingPhase phase_ = MappingPhase::kInitializing;
  Initializer initializer_;
  KeyframeSelector selector_;
  TrajectoryStore store_;
  std::optional<CalibrationEstimator> calibration_;  // from the first frame on: it begins as that was made
  CalibrationEstimator calibration_before_map_;      // what a wrong map says about it is not believed
  std::unique_ptr<LocalMap> map_;                    // null while initialising or locating
  ReferenceConstPtr reference_;
  struct Refining {
    TrackedFrameConstPtr chosen;
    KeyframeReport report;
  };
  std::optional<Refining> refining_;  // the newest keyframe, while refining
  MapId next_map_id_ = 1;
  KeyframeId next_keyframe_id_ = 0;  // of the next map: what may be joined has no two alike
  std::optional<SavedMap> earlier_;  // none: this run began its maps itself
  MapHealth health_;
  Recovery recovery_;
  DeferredTracking deferred_;
  KeyframeDeblurring deblurring_;
  LoopClosing loops_;
  std::optional<std::int64_t> newest_without_map_ns_;  // of the frames in which a map, or the camera, was looked for
  std::vector<FrameConstPtr> initial_frames_;          // that the initialiser had when the map began
  std::shared_ptr<const InitialMap> initial_;          // until its frames have led to the second keyframe
  std::int64_t first_keyframe_ns_ = 0;
  TrackingHint last_;  // the newest tracked frame, relative to last_keyframe_
  KeyframeId last_keyframe_ = 0;
  int frames_without_reference_ = 0;
  std::uint32_t revision_ = 0;  // of the next snapshot
};

}  // namespace mba_vo
