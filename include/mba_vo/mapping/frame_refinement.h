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
/// keyframe after them. When they came, parts of what they see had no depths, or poor ones. What the poses of the
/// keyframes around say of a frame's place is weighed with that, whether it could be tracked better or not. Where a
/// pose contradicts them all the same, as on fast turns, the frame is aligned with all points of the window, each in
/// its own host: one keyframe, blurred itself, may tell too little.
class FrameRefinement {
 public:
  explicit FrameRefinement(const MapperConfig& config);

  /// A frame as it was tracked: newer than all before, or one of them tracked again.
  void add(const TrackedFrameConstPtr& tracked);
  /// The window has been optimised with a new keyframe.
  void update(const LocalMap& map);
  /// No keyframe will come any more.
  void finish(const LocalMap& map);
  void reset();

  bool done() const { return jobs_.empty(); }
  /// Tracks the next frame, or places it as its keyframes say. nullopt if it is better left as it was. Frames that
  /// nobody finds the time for are forgotten.
  std::optional<TrackedFrame> next(const LocalMap& map);

 private:
  /// What the keyframes before and after a frame say of it.
  struct Between {
    SE3 T_reference_mid;  // relative to the reference of the job
    Vector6 sigma;        // standard deviations of its increment [m, rad]
    Vector6 velocity;     // [m/s, rad/s, body frame]
    bool on_fast_turn = false;
  };
  struct Job {
    TrackedFrameConstPtr tracked;
    ReferenceConstPtr reference;
    ExposureTrajectory first;  // as it was tracked, relative to the reference
    std::optional<Between> between;
  };

  void prepareUntil(const LocalMap& map, KeyframeId last);
  static std::optional<Between> between(const LocalMap& map, const Reference& before, const Reference& after,
                                        const Job& job);
  Job jobFor(const TrackedFrameConstPtr& tracked, const SE3& T_map_camera,
             const std::vector<ReferenceConstPtr>& references) const;
  void goOnFrom(const Job& job);
  /// Goes on with what tells of this keyframe.
  void changeReference(const ReferenceConstPtr& reference);
  std::optional<TrackedFrame> track(const Job& job) const;
  TrackingGuess guessFor(const Job& job) const;
  /// To where the keyframes on both sides say that it was, as far as they know better.
  static void moveTowards(const Between& between, TrackedFrame& frame);
  /// The frame by all points of the window, if the keyframes on both sides contradict what is known of it.
  static std::optional<TrackedFrame> doubted(const Between& between, const TrackedFrame& known, const LocalMap& map);

  Tracker tracker_;
  KeyframePolicy policy_;
  double unknown_exposure_;                   // [s]
  std::deque<TrackedFrameConstPtr> waiting_;  // for keyframes, by time
  std::deque<Job> jobs_;                      // by time
  ReferenceConstPtr reference_;               // of the last frame
  MotionState motion_;                        // there, relative to reference_
};

}  // namespace mba_vo
