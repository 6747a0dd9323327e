#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mba_vo/odometry/catch_up_leap.h"
#include "mba_vo/odometry/config.h"
#include "mba_vo/odometry/dead_reckoning.h"
#include "mba_vo/odometry/frame_tracking.h"
#include "mba_vo/odometry/keyframe_scheduler.h"
#include "mba_vo/odometry/recent_frames.h"
#include "mba_vo/odometry/revision_pace.h"
#include "mba_vo/odometry/tracking_phase.h"
#include "mba_vo/odometry/waiting_frames.h"

namespace mba_vo {

/// What waits behind an image that is taken.
enum class Backlog {
  kNothing,  // it is the newest
  kSome,     // the tracker is busy, and may catch up
  kTooMuch   // it does not keep up: not every image can be tracked
};

/// Decides what becomes of every frame: it is tracked at once, ahead of others, or has to wait; and which frames are
/// tracked once more when a reference comes. What it does is named by its phase. Not thread-safe: one thread calls it.
class TrackingLoop {
 public:
  explicit TrackingLoop(const OdometryConfig& config);

  TrackingPhase phase() const { return phase_; }

  /// Every frame gives exactly one result; never null. Where others wait, what cannot be aligned to the map has no
  /// orientation; where too many do, a frame waits as well, to be leapt over by the next that is the newest. `frozen`:
  /// the image has been the same for long, and the camera may be anywhere.
  TrackedFrameConstPtr process(const FrameConstPtr& frame, Backlog backlog = Backlog::kNothing, bool frozen = false);
  /// Takes a newer snapshot; the prior is re-expressed through the poses that came with it. False if it is of no use.
  /// With another keyframe, frames that were lost, or saw the older one badly, and came after the new one's image, wait
  /// to be tracked once more; unless it may not go back, for want of time.
  bool take(const ReferenceConstPtr& reference, bool may_go_back = true);
  /// Tracks the oldest waiting frame: another, late result, for the mapper. Null if none waits, or, where they may, if
  /// they have to go on waiting for a little while: waiting frames pass faster than the mapper makes keyframes, so one
  /// that was asked for is waited for before the view is left.
  TrackedFrameConstPtr trackWaiting(bool may_hold = true);
  std::size_t waitingFrames() const { return waiting_.size(); }
  /// New images are to wait before any of those that wait already is tracked: the newest is where it goes on.
  bool isInHurry() const { return phase_ == TrackingPhase::kCatchingUp && leap_.isHurried(); }
  /// A frame was tried in the last call of process() or trackWaiting(), which was too far away.
  bool hasFailedToLeap() const { return failed_leap_; }
  /// Frames leapt over since the last call, if the next one was tracked: placed between their neighbours, for the
  /// mapper, which tracks them when it has time.
  std::vector<TrackedFrameConstPtr> takeInterpolated();

  /// Forgets the reference and the prior.
  void reset();

  /// Camera to odom at mid-exposure of the last frame with a pose or an orientation; continuous across references and
  /// maps, never rewritten.
  const SE3& T_odom_camera() const { return frames_.T_odom_camera(); }
  /// How it moved at the last measured pose.
  const VelocityEstimate& velocity() const { return frames_.velocity(); }
  /// While lost: camera to odom if it goes on moving as it last did, which nothing measures. nullopt while not lost.
  std::optional<SE3> predicted_T_odom_camera(std::int64_t mid_exposure_ns) const {
    return frames_.predicted_T_odom_camera(mid_exposure_ns);
  }
  /// odom to map by the newest reference: T_map_ref T_odom_ref^-1.
  SE3 T_map_odom() const { return frames_.T_map_odom(); }
  const ReferenceConstPtr& reference() const { return frames_.reference(); }

 private:
  TrackedFrameConstPtr blind(const FrameConstPtr& frame, const std::string& problem);
  bool isSharperImage(const Reference& reference) const;
  bool leave(const Reference& closed);
  bool beginMap(const ReferenceConstPtr& reference);
  void changeKeyframe(const ReferenceConstPtr& reference, bool may_go_back);
  TrackedFrameConstPtr wait(const FrameConstPtr& frame, Backlog backlog);
  void reckon(bool measured, TrackedFrame& result);
  TrackedFrameConstPtr trackAhead(const FrameConstPtr& frame);
  bool hasTimeToRevise(const Frame& image, Backlog backlog);
  void leaveRevisions();
  std::shared_ptr<TrackedFrame> trackNow(const WaitingFrame& next, bool has_time);
  std::shared_ptr<TrackedFrame> track(const WaitingFrame& next);
  TrackedFrameConstPtr goOnWith(const FrameConstPtr& frame);
  std::shared_ptr<TrackedFrame> leap(const WaitingFrame& waits, std::size_t over);
  void giveUpWaiting();
  void goOnFrom(const WaitingFrame& next, const TrackingState& before, TrackedFrame& tracked);
  void change(TrackingEvent event) {
    phase_ = nextPhase(trackingTable(), phase_, event);
    if (phase_ != TrackingPhase::kCatchingUp) leap_.reset();
  }

  TrackingPhase phase_ = TrackingPhase::kNoMap;
  FrameTracking frames_;
  KeyframeScheduler scheduler_;
  double longest_wait_;  // [s]
  MotionPriorConfig motion_prior_;
  DeadReckoning reckoning_;  // since the newest frame that was tracked
  WaitingFrames waiting_;
  CatchUpLeap leap_;
  bool failed_leap_ = false;
  std::vector<TrackedFrameConstPtr> interpolated_;  // not taken yet
  RecentFrames recent_;                             // before those that wait
  TrackingState newest_;                            // while revising: by first results
  RevisionPace revision_pace_;
  double worst_need_ = 0.0;  // of the frames being revised, when they were tracked before
  std::string no_map_reason_;
};

}  // namespace mba_vo
