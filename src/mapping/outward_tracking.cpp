#include "mba_vo/mapping/outward_tracking.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "mba_vo/mapping/local_map.h"
#include "mba_vo/trajectory/finite_difference_velocity.h"

namespace mba_vo {
namespace {

constexpr double kLeastVisible = 0.35;      // share of the keyframe's points; with fewer, poses drift
constexpr KeyframeId kSettledKeyframe = 4;  // from this one on the first keyframe's points have good depths

void degrade(TrackedFrame& tracked, const char* reason) {
  if (tracked.status != TrackingStatus::kTracking) return;
  tracked.status = TrackingStatus::kDegraded;
  tracked.reason = reason;
}

}  // namespace

BodyMotion referenceMotion(const InitialMap& initial) {
  const std::int64_t origin_ns = initial.reference->mid_exposure_ns;
  const InitialMap::Pose* before = nullptr;
  const InitialMap::Pose* after = nullptr;
  for (const InitialMap::Pose& pose : initial.poses) {  // by time
    if (pose.frame->mid_exposure_ns < origin_ns) before = &pose;
    if (pose.frame->mid_exposure_ns > origin_ns && !after) after = &pose;
  }
  FiniteDifferenceVelocity motion;
  if (before) motion.add(before->frame->mid_exposure_ns, before->T_reference_frame, std::nullopt);
  motion.add(origin_ns, SE3(), std::nullopt);
  if (after) motion.add(after->frame->mid_exposure_ns, after->T_reference_frame, std::nullopt);
  return motion.motionOfMiddle();
}

TrackingHint newestOf(const InitialMap& initial, const ExposureTrajectory& start) {
  const FrameConstPtr& reference = initial.reference;
  // A map of measured depths begins with the first images.
  if (initial.metric || initial.poses.empty() ||
      initial.poses.back().frame->mid_exposure_ns <= reference->mid_exposure_ns) {
    return {reference->sequence, reference->mid_exposure_ns, start};
  }
  FiniteDifferenceVelocity motion;
  if (initial.poses.size() > 1) {
    const InitialMap::Pose& before = *std::prev(initial.poses.end(), 2);
    motion.add(before.frame->mid_exposure_ns, before.T_reference_frame, std::nullopt);
  }
  const InitialMap::Pose& newest = initial.poses.back();
  motion.add(newest.frame->mid_exposure_ns, newest.T_reference_frame, std::nullopt);
  return {newest.frame->sequence,
          newest.frame->mid_exposure_ns,
          {newest.T_reference_frame, motion.velocityOfLast(), newest.frame->exposure.value_or(start.exposure)}};
}

TrackedFrameConstPtr referenceItself(const Reference& reference, const FrameConstPtr& frame,
                                     const ExposureTrajectory& trajectory) {
  auto tracked = std::make_shared<TrackedFrame>();
  tracked->frame = frame;
  tracked->status = TrackingStatus::kTracking;
  tracked->reference = reference.id;
  tracked->trajectory = trajectory;
  return tracked;
}

OutwardTracking::OutwardTracking(const MapperConfig& config, std::shared_ptr<const InitialMap> initial,
                                 const MotionState& start, std::deque<FrameConstPtr> frames,
                                 ReferenceConstPtr first_keyframe)
    : tracker_(config.tracker),
      unknown_exposure_(config.tracker.unknown_exposure),
      initial_(std::move(initial)),
      frames_(std::move(frames)),
      first_keyframe_(std::move(first_keyframe)),
      motion_(start) {}

bool OutwardTracking::isReady(const LocalMap& map) const { return map.newestKeyframe() >= kSettledKeyframe; }

void OutwardTracking::update(const LocalMap& map) {
  const KeyframeId keyframe = first_keyframe_->id.keyframe_id;
  if (map.has(keyframe) && map.newestKeyframe() <= kSettledKeyframe) first_keyframe_ = map.makeReference(keyframe);
}

TrackingGuess OutwardTracking::guessFor(const Frame& frame) const {
  TrackingGuess guess(motion_.priorAt(frame.mid_exposure_ns), frame.exposure.value_or(unknown_exposure_));
  guess.brightness = brightness_;
  const auto same = [&](const InitialMap::Pose& pose) { return pose.frame->sequence == frame.sequence; };
  const auto known = std::find_if(initial_->poses.begin(), initial_->poses.end(), same);
  if (known != initial_->poses.end()) guess.trajectory.T_reference_mid = known->T_reference_frame;
  return guess;
}

TrackedFrame OutwardTracking::next() {
  const FrameConstPtr frame = std::move(frames_.front());
  frames_.pop_front();
  TrackedFrame tracked = tracker_.track(*first_keyframe_, frame, guessFor(*frame));
  // What follows has nothing better to go by than a pose that is doubtful.
  if (seen_badly_) degrade(tracked, "tracked from a frame that was seen badly");
  if (tracked.measures.visible_fraction < kLeastVisible) degrade(tracked, "sees little of the map's first keyframe");
  seen_badly_ = tracked.status == TrackingStatus::kDegraded;
  if (tracked.tracked()) {
    motion_.update(tracked);
    brightness_ = tracked.brightness;
  } else {
    frames_.clear();
  }
  return tracked;
}

}  // namespace mba_vo
