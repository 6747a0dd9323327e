#include "mba_vo/odometry/tracking_loop.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mba_vo/image/image_content.h"
#include "mba_vo/odometry/tracking_results.h"
#include "mba_vo/trajectory/pose_interpolation.h"

namespace mba_vo {
namespace {

constexpr double kMapperTime = 1.0;           // [s] frames wait for so much longer than the initialiser keeps them
constexpr double kLongestRevision = 1.0;      // [s] of frames that are tracked once more while new ones come
constexpr double kUnknownVariance = 1e6;      // of a position that nothing has measured [m^2]
constexpr double kLargestUncertainty = 0.02;  // depths; of a place that is published: of so much a map is made
constexpr const char* kNoMap = "no map yet";
constexpr const char* kFrozen = "the image has been the same for too long: frozen";
constexpr const char* kNoContent = "the image shows nothing: black, saturated, or the lens is covered";

}  // namespace

TrackingLoop::TrackingLoop(const OdometryConfig& config)
    : frames_(config.tracker),
      scheduler_(KeyframePolicy(config.keyframe)),
      longest_wait_(config.mapper.initializer.buffer_seconds + kMapperTime),
      motion_prior_(config.tracker.motion_prior),
      reckoning_(config.tracker, longest_wait_),
      no_map_reason_(kNoMap) {}

TrackedFrameConstPtr TrackingLoop::process(const FrameConstPtr& frame, Backlog backlog, bool frozen) {
  failed_leap_ = false;
  if (!hasContent(frame->pyramid)) return blind(frame, kNoContent);
  if (frozen) return blind(frame, kFrozen);
  if (phase_ == TrackingPhase::kRevising && !hasTimeToRevise(*frame, backlog)) leaveRevisions();
  if (phase_ == TrackingPhase::kRevising) {
    if (auto tracked = trackAhead(frame)) return tracked;
  }
  if (phase_ == TrackingPhase::kTracking && backlog == Backlog::kTooMuch) {
    change(TrackingEvent::kFallBehind);
    leap_.hurry();
  }
  if (phase_ == TrackingPhase::kTracking || phase_ == TrackingPhase::kLost) {
    return trackNow({frame, true, false, false}, backlog == Backlog::kNothing);
  }
  if (isInHurry() && backlog == Backlog::kNothing) {
    if (auto tracked = goOnWith(frame)) return tracked;
  }
  return wait(frame, backlog);
}

bool TrackingLoop::take(const ReferenceConstPtr& reference, bool may_go_back) {
  if (reference->cause == ReferenceCause::kMapClosed) return leave(*reference);
  if (isSharperImage(*reference)) {
    frames_.replaceImage(reference);
    return true;
  }
  const bool same_map = frames_.reference() && frames_.reference()->id.map_id == reference->id.map_id;
  if (!same_map) return reference->hint && beginMap(reference);
  changeKeyframe(reference, may_go_back);
  return true;
}

TrackedFrameConstPtr TrackingLoop::trackWaiting(bool may_hold) {
  failed_leap_ = false;
  if (phase_ == TrackingPhase::kNoMap || waiting_.empty()) return nullptr;
  waiting_.dropUntil(frames_.state().lastNs());
  if (waiting_.empty()) {
    change(TrackingEvent::kNothingWaits);
    if (frames_.lost()) change(TrackingEvent::kFrameLost);
    return nullptr;
  }
  if (may_hold && scheduler_.holds(waiting_)) return nullptr;
  std::size_t over = 0;
  if (may_hold && phase_ == TrackingPhase::kCatchingUp) {
    over = leap_.over(waiting_.size(), waiting_.back().frame->mid_exposure_ns);
  }
  const auto tracked = over > 0 ? leap(waiting_.at(over), over) : track(waiting_.takeFirst());
  if (!tracked) return nullptr;
  if (phase_ == TrackingPhase::kCatchingUp) tracked->tracked() ? leap_.reach(over) : leap_.lose();
  if (leap_.isHopeless()) giveUpWaiting();
  if (phase_ != TrackingPhase::kRevising || tracked->tracked()) return tracked;
  leaveRevisions();
  return nullptr;
}

/// The newest image, while others wait. Null if it is out of reach.
TrackedFrameConstPtr TrackingLoop::goOnWith(const FrameConstPtr& frame) {
  waiting_.dropUntil(frames_.state().lastNs());
  const std::size_t over = leap_.over(waiting_.size() + 1, frame->mid_exposure_ns);
  return over > 0 && over == waiting_.size() ? leap({frame, true, false, false}, over) : nullptr;
}

/// To a frame that comes after the first `over` that wait, which are left out. Null if it is out of reach.
std::shared_ptr<TrackedFrame> TrackingLoop::leap(const WaitingFrame& waits, std::size_t over) {
  const WaitingFrame next = waits;
  const TrackingState before = frames_.state();
  auto tracked = frames_.leapTo(next.frame, reckoning_.turnBetween(before.lastNs(), next.frame->mid_exposure_ns));
  failed_leap_ = !tracked;
  if (failed_leap_) {
    leap_.fail(over);
    return nullptr;
  }
  std::vector<FrameConstPtr> left_out;
  for (; over > 0; --over) left_out.push_back(waiting_.takeFirst().frame);
  waiting_.dropUntil(next.frame->mid_exposure_ns);
  goOnFrom(next, before, *tracked);
  const StampedPose begin{before.lastNs(), before.last().T_reference_mid, before.last().velocity};
  interpolated_ = placedBetween(begin, *tracked, left_out, motion_prior_, frames_.meanDepth());
  return tracked;
}

/// The camera is lost: what is looked for is where it is now.
void TrackingLoop::giveUpWaiting() {
  waiting_.clear();
  change(TrackingEvent::kNothingWaits);
  change(TrackingEvent::kFrameLost);
}

std::vector<TrackedFrameConstPtr> TrackingLoop::takeInterpolated() { return std::exchange(interpolated_, {}); }

void TrackingLoop::reset() {
  change(TrackingEvent::kReset);
  frames_.reset();
  waiting_.clear();
  interpolated_.clear();
  recent_.clear();
  no_map_reason_ = kNoMap;
  scheduler_.meet();
  reckoning_.reset();
  revision_pace_.reset();
}

/// An image to which nothing can be aligned.
TrackedFrameConstPtr TrackingLoop::blind(const FrameConstPtr& frame, const std::string& problem) {
  const bool has_map = phase_ != TrackingPhase::kNoMap;
  const auto result = untracked(frame, has_map ? TrackingStatus::kLost : TrackingStatus::kInitializing, problem);
  result->blind = true;
  if (has_map) frames_.lose(frame->mid_exposure_ns, true);
  if (waiting_.empty() && has_map) change(TrackingEvent::kFrameLost);
  return result;
}

/// Of the keyframe in use. The demand for the next one remains, and what saw this one badly still does.
bool TrackingLoop::isSharperImage(const Reference& reference) const {
  return reference.cause == ReferenceCause::kSharperImage && frames_.reference() &&
         frames_.reference()->id.map_id == reference.id.map_id &&
         frames_.reference()->id.keyframe_id == reference.id.keyframe_id;
}

/// The mapper has given up the map: the next one is waited for.
bool TrackingLoop::leave(const Reference& closed) {
  if (!frames_.reference() || frames_.reference()->id.map_id != closed.id.map_id) return false;
  change(TrackingEvent::kMapClosed);
  frames_.leave();
  recent_.clear();
  no_map_reason_ = closed.closed_because;
  return true;
}

bool TrackingLoop::beginMap(const ReferenceConstPtr& reference) {
  frames_.begin(reference, reckoning_.T_odom_cameraAt(reference->hint->mid_exposure_ns));
  recent_.clear();
  scheduler_.meet();
  leap_.reset();
  waiting_.dropUntil(frames_.state().lastNs());
  change(TrackingEvent::kMapBegins);
  if (waiting_.empty()) change(TrackingEvent::kNothingWaits);
  return true;
}

/// Frames that saw the older keyframe badly and came after the new one's image are to be tracked once more.
void TrackingLoop::changeKeyframe(const ReferenceConstPtr& reference, bool may_go_back) {
  const bool lost = phase_ == TrackingPhase::kLost || frames_.lost();
  const bool found = reference->cause == ReferenceCause::kFoundAgain && lost;
  const bool newest_known = phase_ == TrackingPhase::kRevising || phase_ == TrackingPhase::kTracking;
  if (phase_ != TrackingPhase::kRevising) {
    newest_ = frames_.state();
    worst_need_ = 0.0;
  }
  const SE3 T_new_old = found ? frames_.recover(reference, reckoning_.T_odom_cameraAt(reference->hint->mid_exposure_ns))
                              : frames_.changeReference(reference);
  newest_.changeReference(T_new_old);
  recent_.changeReference(T_new_old);
  leap_.lookFurther();
  scheduler_.meet();
  std::vector<RecentFrames::Entry> again =
      recent_.takeAfter(found ? frames_.state().lastNs() : reference->mid_exposure_ns);
  if (found && !again.empty()) again.front().before = frames_.state();
  const bool no_time = leap_.isPressed() || (newest_known && revision_pace_.rests(newest_.lastNs()));
  if (!may_go_back || no_time || again.empty()) return change(TrackingEvent::kKeyframe);
  frames_.goOnFrom(again.front().before);
  for (const RecentFrames::Entry& entry : again) worst_need_ = std::max(worst_need_, entry.need);
  waiting_.addRevisions(again);
  revision_pace_.begin();
  change(newest_known ? TrackingEvent::kRevise : TrackingEvent::kGoBack);
}

/// A frame that comes too early for what is being done.
TrackedFrameConstPtr TrackingLoop::wait(const FrameConstPtr& frame, Backlog backlog) {
  const bool has_map = phase_ != TrackingPhase::kNoMap;
  const auto result = untracked(frame, TrackingStatus::kInitializing,
                                has_map ? "earlier frames are still being tracked" : no_map_reason_);
  // With a map, what waits needs the time: the sooner it is tracked, the sooner there is a pose.
  if (!has_map && backlog == Backlog::kNothing) reckon(reckoning_.track(frame), *result);
  waiting_.add({frame, false, false, false});
  waiting_.dropOlderThan(longest_wait_);
  if (has_map) change(TrackingEvent::kImageWaits);
  return result;
}

/// What is not aligned to the map has a rotation all the same, and for a moment a position.
void TrackingLoop::reckon(bool measured, TrackedFrame& result) {
  frames_.moveTo(reckoning_.T_odom_camera());
  result.trajectory = reckoning_.turn();
  result.covariance.diagonal().head<3>().setConstant(kUnknownVariance);
  result.covariance.block<3, 3>(3, 3) = reckoning_.covariance();
  result.predicted = measured && phase_ != TrackingPhase::kNoMap && reckoning_.positionSigma() <= kLargestUncertainty;
  result.orientation_only = measured && !result.predicted;
  if (!result.predicted) return;
  result.trajectory = {frames_.T_reference_odom() * reckoning_.T_odom_camera(), reckoning_.velocity(),
                       result.frame->exposure.value_or(0.0)};
  result.reason = "its turn is measured and its place predicted: " + result.reason;
}

/// While frames are tracked once more, a new frame gets a first result from what is known without them, and then waits
/// behind them. Null if it is lost: it then waits for them.
TrackedFrameConstPtr TrackingLoop::trackAhead(const FrameConstPtr& frame) {
  const auto tracked = frames_.trackAhead(frame, newest_);
  if (!tracked) {
    change(TrackingEvent::kFrameLost);
    return nullptr;
  }
  waiting_.add({frame, true, false, true});
  reckoning_.beginAt(*tracked, frames_.T_odom_camera(), frames_.meanDepth());
  if (waiting_.seconds() > kLongestRevision) leaveRevisions();
  return tracked;
}

bool TrackingLoop::hasTimeToRevise(const Frame& image, Backlog backlog) {
  const bool needed = KeyframeScheduler::isBad(worst_need_);
  return needed && backlog != Backlog::kTooMuch && !revision_pace_.isTooSlow(waiting_.size(), image.mid_exposure_ns);
}

/// The first results of the frames that wait are good enough.
void TrackingLoop::leaveRevisions() {
  frames_.goOnFrom(newest_);
  frames_.find();
  waiting_.clear();
  change(TrackingEvent::kGoOn);
}

/// A new image, while nothing waits.
std::shared_ptr<TrackedFrame> TrackingLoop::trackNow(const WaitingFrame& next, bool has_time) {
  const bool turn_first = phase_ == TrackingPhase::kLost && has_time;
  const bool turned = turn_first && reckoning_.track(next.frame);
  auto tracked = track(next);
  if (tracked->tracked()) return tracked;
  if (turn_first || has_time) reckon(turn_first ? turned : reckoning_.track(next.frame), *tracked);
  return tracked;
}

std::shared_ptr<TrackedFrame> TrackingLoop::track(const WaitingFrame& next) {
  const TrackingState before = frames_.state();
  auto tracked = frames_.track(next.frame, reckoning_.turnBetween(before.lastNs(), next.frame->mid_exposure_ns));
  goOnFrom(next, before, *tracked);
  return tracked;
}

/// `tracked`: the same frame, by what was known `before`.
void TrackingLoop::goOnFrom(const WaitingFrame& next, const TrackingState& before, TrackedFrame& tracked) {
  RecentFrames::Entry entry = {next.frame, next.in_time, next.mapped, KeyframeScheduler::kLost, before};
  if (tracked.tracked()) {
    scheduler_.judge(*frames_.reference(), next.mapped, tracked);
    entry.mapped = next.mapped || !tracked.provisional;
    entry.need = scheduler_.need();
    if (waiting_.empty()) reckoning_.beginAt(tracked, frames_.T_odom_camera(), frames_.meanDepth());
  }
  recent_.add(entry, !tracked.tracked() || scheduler_.isWorthRevision());
  const bool waited = phase_ != TrackingPhase::kTracking && phase_ != TrackingPhase::kLost;
  if (waited && !waiting_.empty()) return;
  if (waited && phase_ == TrackingPhase::kRevising && !tracked.tracked()) return;  // the first results stand
  if (waited) change(TrackingEvent::kNothingWaits);
  change(tracked.tracked() ? TrackingEvent::kFrameTracked : TrackingEvent::kFrameLost);
}

}  // namespace mba_vo
