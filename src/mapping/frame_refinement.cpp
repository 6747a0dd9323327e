#include "mba_vo/mapping/frame_refinement.h"

#include <algorithm>
#include <utility>

#include "mba_vo/mapping/local_map.h"
#include "mba_vo/tracking/frame_measures.h"
#include "mba_vo/trajectory/pose_interpolation.h"
#include "mba_vo/window/motion_alignment.h"

namespace mba_vo {
namespace {

constexpr double kTolerance = 2.0;      // by which more error may be expected of a pose than before
constexpr std::size_t kMaxFrames = 24;  // that wait, or are to be tracked: each holds its images

// Expected error of a place between two keyframes, mostly by changes of the acceleration: hands change that of a turn
// faster.
constexpr double kLinearError = 0.005;  // [median depths/s] times the time between them
constexpr double kAngularError = 0.05;  // [rad/s]

// Squared disagreement with it from which a pose is doubtful. Where keyframes are sharp, or farther apart, they tell
// little of what lies between.
constexpr double kContradiction = 36.0;
constexpr double kPlainContradiction = 1000.0;

constexpr double kLongestGap = 2.0 * kLongestPrediction;  // [s] between keyframes that tell what lies between

double secondsBetween(std::int64_t from_ns, std::int64_t to_ns) { return 1e-9 * static_cast<double>(to_ns - from_ns); }

/// With its velocity by the poses of the keyframes around, if they are near: these have been compared with many others.
/// That by the frames next to it, and by its blur, cannot tell a turn from a sideways motion where these frames cannot.
StampedPose stampedPoseByNeighbours(const LocalMap& map, KeyframeId keyframe) {
  StampedPose at = map.stampedPose(keyframe);
  const auto before = map.keyframeBefore(keyframe);
  const auto after = map.keyframeAfter(keyframe);
  if (!before || !after) return at;
  const StampedPose first = map.stampedPose(*before);
  const StampedPose last = map.stampedPose(*after);
  const double gap = std::max(secondsBetween(first.mid_exposure_ns, at.mid_exposure_ns),
                              secondsBetween(at.mid_exposure_ns, last.mid_exposure_ns));
  if (gap < kLongestGap) at.velocity = velocityByPoses(first, at, last);
  return at;
}

/// Of a keyframe's points within its exposure, median [px].
double blurOf(const Reference& keyframe) {
  return measureFrame(keyframe, {SE3(), keyframe.motion.velocity, keyframe.exposure.value_or(0.0)}).blur_length_px;
}

template <typename T>
void dropOldest(std::deque<T>& queue) {
  while (queue.size() > kMaxFrames) queue.pop_front();
}

}  // namespace

FrameRefinement::FrameRefinement(const MapperConfig& config)
    : tracker_(config.tracker), policy_(config.keyframe), unknown_exposure_(config.tracker.unknown_exposure) {}

void FrameRefinement::add(const TrackedFrameConstPtr& tracked) {
  const auto same = [&](const TrackedFrameConstPtr& t) { return t->frame->sequence == tracked->frame->sequence; };
  const auto known = std::find_if(waiting_.begin(), waiting_.end(), same);
  if (known != waiting_.end()) {
    *known = tracked;
    return;
  }
  const auto isLater = [](std::int64_t ns, const TrackedFrameConstPtr& t) { return ns < t->frame->mid_exposure_ns; };
  waiting_.insert(std::upper_bound(waiting_.begin(), waiting_.end(), tracked->frame->mid_exposure_ns, isLater),
                  tracked);
  dropOldest(waiting_);
}

void FrameRefinement::update(const LocalMap& map) {
  if (const auto before = map.keyframeBefore(map.newestKeyframe())) prepareUntil(map, *before);
}

void FrameRefinement::finish(const LocalMap& map) { prepareUntil(map, map.newestKeyframe()); }

void FrameRefinement::reset() {
  waiting_.clear();
  jobs_.clear();
  reference_.reset();
}

/// Frames up to that keyframe are to be tracked against it, or the one before, whichever shows more of what they see.
void FrameRefinement::prepareUntil(const LocalMap& map, KeyframeId last) {
  std::vector<ReferenceConstPtr> references = {map.makeReference(last)};
  if (const auto before = map.keyframeBefore(last)) references.push_back(map.makeReference(*before));
  const std::int64_t end_ns = references.front()->mid_exposure_ns;
  while (!waiting_.empty() && waiting_.front()->frame->mid_exposure_ns <= end_ns) {
    jobs_.push_back(jobFor(waiting_.front(), map.T_map_camera(*waiting_.front()), references));
    jobs_.back().between = between(map, *references.back(), *references.front(), jobs_.back());
    waiting_.pop_front();
  }
  dropOldest(jobs_);
}

FrameRefinement::Job FrameRefinement::jobFor(const TrackedFrameConstPtr& tracked, const SE3& T_map_camera,
                                             const std::vector<ReferenceConstPtr>& references) const {
  Job best;
  double least_need = 0.0;
  for (const ReferenceConstPtr& reference : references) {
    Job job{tracked, reference, tracked->trajectory, std::nullopt};
    job.first.T_reference_mid = reference->T_map_reference.inverse() * T_map_camera;
    const double need = policy_.need(*reference, measureFrame(*reference, job.first), tracked->brightness);
    if (best.reference && need >= least_need) continue;
    least_need = need;
    best = std::move(job);
  }
  return best;
}

std::optional<FrameRefinement::Between> FrameRefinement::between(const LocalMap& map, const Reference& before,
                                                                 const Reference& after, const Job& job) {
  const std::int64_t ns = job.tracked->frame->mid_exposure_ns;
  const double interval = secondsBetween(before.mid_exposure_ns, after.mid_exposure_ns);
  const bool lies_between = before.mid_exposure_ns < ns && ns < after.mid_exposure_ns;
  if (!lies_between || interval >= kLongestGap) return std::nullopt;
  const KeyframeId first = before.id.keyframe_id;
  const KeyframeId second = after.id.keyframe_id;
  const StampedPose there =
      interpolatePose(stampedPoseByNeighbours(map, first), stampedPoseByNeighbours(map, second), ns);
  Between result;
  result.T_reference_mid = job.reference->T_map_reference.inverse() * there.T_map_camera;
  result.velocity = interpolatePose(map.stampedPose(first), map.stampedPose(second), ns).velocity;
  result.sigma.head<3>().setConstant(kLinearError * interval * medianDepth(*job.reference));
  result.sigma.tail<3>().setConstant(kAngularError * interval);
  result.on_fast_turn = interval < kLongestPrediction && std::max(blurOf(before), blurOf(after)) >= kLongBlur;
  return result;
}

/// From a frame that is left as it was.
void FrameRefinement::goOnFrom(const Job& job) {
  reference_ = job.reference;
  ExposureTrajectory from = job.first;
  // A keyframe's motion is known better than when it was tracked.
  if (job.tracked->frame->mid_exposure_ns == job.reference->mid_exposure_ns)
    from.velocity = job.reference->motion.velocity;
  motion_ = MotionState(from, job.tracked->frame->mid_exposure_ns);
}

TrackingGuess FrameRefinement::guessFor(const Job& job) const {
  const Frame& frame = *job.tracked->frame;
  TrackingGuess guess(motion_.priorAt(frame.mid_exposure_ns), frame.exposure.value_or(unknown_exposure_));
  guess.brightness = job.tracked->brightness;
  guess.trajectory = job.first;
  guess.is_close = true;
  return guess;
}

void FrameRefinement::changeReference(const ReferenceConstPtr& reference) {
  const auto pose = reference->T_map_keyframe.find(reference_->id.keyframe_id);
  const bool in_window = pose != reference->T_map_keyframe.end();
  const SE3& T_map_old = in_window ? pose->second : reference_->T_map_reference;
  motion_.changeReference(reference->T_map_reference.inverse() * T_map_old);
  reference_ = reference;
}

void FrameRefinement::moveTowards(const Between& between, TrackedFrame& frame) {
  SE3& T_reference_mid = frame.trajectory.T_reference_mid;
  T_reference_mid =
      fusedPose(T_reference_mid, frame.covariance.topLeftCorner<6, 6>(), between.T_reference_mid, between.sigma);
}

std::optional<TrackedFrame> FrameRefinement::doubted(const Between& between, const TrackedFrame& known,
                                                     const LocalMap& map) {
  const auto disagreement = [&](const TrackedFrame& frame) {
    return squaredMahalanobisDistance(frame.trajectory.T_reference_mid, frame.covariance.topLeftCorner<6, 6>(),
                                      between.T_reference_mid, between.sigma);
  };
  const double doubt = disagreement(known);
  if (doubt < (between.on_fast_turn ? kContradiction : kPlainContradiction)) return std::nullopt;
  TrackedFrame frame = known;
  frame.trajectory.T_reference_mid = between.T_reference_mid;
  frame.trajectory.velocity = between.velocity;
  const std::optional<ExposureTrajectory> found = map.align(frame);
  if (!found) return std::nullopt;
  frame.trajectory = *found;
  if (disagreement(frame) >= doubt) return std::nullopt;
  return frame;
}

std::optional<TrackedFrame> FrameRefinement::track(const Job& job) const {
  TrackedFrame refined = tracker_.track(*job.reference, job.tracked->frame, guessFor(job));
  // Some points that it was tracked by may have left the window.
  const bool better = refined.expected_error <= kTolerance * job.tracked->expected_error;
  if (refined.status != TrackingStatus::kTracking || !better) return std::nullopt;
  return refined;
}

std::optional<TrackedFrame> FrameRefinement::next(const LocalMap& map) {
  const Job job = std::move(jobs_.front());
  jobs_.pop_front();
  const bool is_keyframe = job.tracked->frame->mid_exposure_ns == job.reference->mid_exposure_ns;
  if (!reference_ || is_keyframe) {
    goOnFrom(job);
    return std::nullopt;
  }
  if (reference_ != job.reference) changeReference(job.reference);
  std::optional<TrackedFrame> refined = track(job);
  if (!refined && !job.between) {
    goOnFrom(job);
    return std::nullopt;
  }
  TrackedFrame result = refined.value_or(*job.tracked);
  if (!refined) {
    result.reference = job.reference->id;
    result.trajectory = job.first;
  }
  if (job.between) {
    if (std::optional<TrackedFrame> better = doubted(*job.between, result, map)) result = std::move(*better);
    moveTowards(*job.between, result);
  }
  motion_.update(result);
  // What was doubtful when it came has been published so.
  result.status = job.tracked->status;
  result.reason = job.tracked->reason;
  return result;
}

}  // namespace mba_vo
