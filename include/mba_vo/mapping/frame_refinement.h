#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "mba_vo/mapping/mapper_config.h"
#include "mba_vo/tracking/motion_state.h"
#include "mba_vo/tracking/tracked_frame.h"
#include "mba_vo/tracking/tracker.h"

namespace mba_vo {

class LocalMap;

/// Tracks the frames between keyframes once more, for the trajectory: when the window has been optimised with a second
/// keyframe after them. When they came, parts of what they see had no depths, or poor ones. Where keyframes come fast,
/// as on fast turns, they are aligned with all points of the window, each in its own host: one keyframe, blurred itself,
/// may tell too little.
class FrameRefinement {
 public:
  explicit FrameRefinement(const MapperConfig& config);

  /// A frame as it was tracked: newer than all before, or one of them tracked again.
  void add(const TrackedFrameConstPtr& tracked);
  /// The window has been optimised with a new keyframe.
  void update(LocalMap& map);
  /// No keyframe will come any more.
  void finish(LocalMap& map);
  void reset();

  bool done() const { return jobs_.empty(); }
  /// Tracks the next frame. nullopt if it is better left as it was. Frames that nobody finds the time for are
  /// forgotten.
  std::optional<TrackedFrame> next(const LocalMap& map);

 private:
  struct Job {
    TrackedFrameConstPtr tracked;
    ReferenceConstPtr reference;
    ExposureTrajectory first;                   // as it was tracked, relative to the reference
    std::optional<ExposureTrajectory> between;  // as the keyframes before and after it say, relative to the reference
    double interval = 0.0;                      // between these [s]
  };

  void prepareUntil(LocalMap& map, KeyframeId last);
  Job jobFor(const TrackedFrameConstPtr& tracked, const SE3& T_map_camera,
             const std::vector<ReferenceConstPtr>& references) const;
  void goOnFrom(const Job& job);
  /// Goes on with what tells of this keyframe.
  void changeReference(const ReferenceConstPtr& reference);
  static std::optional<TrackedFrame> align(const Job& job, const LocalMap& map);
  std::optional<TrackedFrame> track(const Job& job) const;
  TrackingGuess guessFor(const Job& job) const;
  /// Weighs the pose with what the keyframes before and after say.
  static void hold(const Job& job, TrackedFrame& refined);

  Tracker tracker_;
  KeyframePolicy policy_;
  double unknown_exposure_;                   // [s]
  std::deque<TrackedFrameConstPtr> waiting_;  // for keyframes, by time
  std::deque<Job> jobs_;                      // by time
  ReferenceConstPtr reference_;               // of the last frame
  MotionState motion_;                        // there, relative to reference_
};

}  // namespace mba_vo
