#include "mba_vo/mapping/mapper.h"

#include <utility>

#include "mba_vo/mapping/backward_tracking.h"
#include "mba_vo/mapping/kinematic_blur.h"

namespace mba_vo {
namespace {

constexpr KeyframeId kSettledKeyframe = 4;  // from this one on the first keyframe's points have good depths
constexpr int kFramesUntilResend = 15;      // the first reference may still be on its way for a while

}  // namespace

class Mapper::Impl {
 public:
  explicit Impl(const MapperConfig& config)
      : config_(config),
        initializer_(config.initializer),
        keyframe_policy_(config.keyframe),
        calibration_(config.start_correction) {}

  MapperOutput process(const TrackedFrameConstPtr& frame) {
    if (!map_) return initialize(frame->frame);
    if (frame->frame->mid_exposure_ns <= last_.mid_exposure_ns) return revise(frame);
    // A tracker that was lost for so long that it gave up its reference reports INITIALIZING.
    if (frame->status == TrackingStatus::kLost || (lost_since_ns_ && !frame->tracked())) return handleLost(*frame);
    if (!frame->tracked()) return resend();
    if (frame->reference.map_id != map_->id()) return stale(*frame);
    lost_since_ns_.reset();
    frames_without_reference_ = 0;
    if (frame->provisional) {
      store_.addFrame(*frame);
      return {};
    }
    return refine(frame);
  }

  bool hasDeferredWork() const { return backward_ && !backward_->done(); }

  bool doDeferredWork() {
    if (!hasDeferredWork() || map_->newestKeyframe() < kSettledKeyframe) return false;
    trackBackwards();
    return true;
  }

  void finishDeferredWork() {
    while (hasDeferredWork()) trackBackwards();
  }

  void reset() {
    forgetMap();
    calibration_ = CalibrationEstimator(config_.start_correction);
  }

  void forgetMap() {
    map_.reset();
    reference_.reset();
    initializer_.reset();
    lost_since_ns_.reset();
    candidate_.reset();
    backward_.reset();
    first_keyframe_.reset();
    motion_ = {};
    last_ = {};
  }

  ReferenceConstPtr currentReference() const { return reference_; }
  const CalibrationCorrection& correction() const { return calibration_.correction(); }
  const TrajectoryStore& store() const { return store_; }
  std::vector<MapPoint> points() const { return map_ ? map_->points() : std::vector<MapPoint>{}; }

 private:
  MapperOutput initialize(const FrameConstPtr& frame) {
    MapperOutput output;
    std::unique_ptr<InitialMap> initial = initializer_.add(frame);
    if (!initial) {
      output.message = initializer_.reason();
      return output;
    }
    const Vector6 velocity = referenceVelocity(*initial);
    map_ = std::make_unique<LocalMap>(config_, next_map_id_++, *initial, velocity, store_, calibration_);
    output.message =
        "map " + std::to_string(map_->id()) + " initialised with " + std::to_string(initial->points.size()) + " points";
    reference_ = begin(std::move(initial), velocity);
    initializer_.reset();
    output.reference = reference_;
    return output;
  }

  /// The first reference, with a hint about its own frame: the tracker goes on from there with the frames that had to
  /// wait. Those that came before are tracked backwards when there is time.
  ReferenceConstPtr begin(std::unique_ptr<InitialMap> initial, const Vector6& velocity) {
    const FrameConstPtr frame = initial->reference;
    const ExposureTrajectory start{SE3(), velocity, frame->exposure.value_or(config_.tracker.unknown_exposure)};
    const std::shared_ptr<Reference> reference = map_->makeReference(map_->newestKeyframe());
    reference->hint = TrackingHint{frame->sequence, frame->mid_exposure_ns, start};
    reference_ = reference;
    integrate(referenceItself(*reference, frame, start));
    backward_.emplace(config_, std::move(initial), MotionState(start, frame->mid_exposure_ns),
                      initializer_.bufferedFrames());
    first_keyframe_ = reference_;
    return reference;
  }

  /// While the first keyframe is in the window, its points get better.
  void updateFirstKeyframe() {
    if (!first_keyframe_ || !map_->has(first_keyframe_->id.keyframe_id)) return;
    if (map_->newestKeyframe() <= kSettledKeyframe) {
      first_keyframe_ = map_->makeReference(first_keyframe_->id.keyframe_id);
    }
  }

  void trackBackwards() {
    const TrackedFrame tracked = backward_->next(*first_keyframe_);
    if (tracked.tracked()) store_.addFrame(tracked);
  }

  static TrackedFrameConstPtr referenceItself(const Reference& reference, const FrameConstPtr& frame,
                                              const ExposureTrajectory& trajectory) {
    auto tracked = std::make_shared<TrackedFrame>();
    tracked->frame = frame;
    tracked->status = TrackingStatus::kTracking;
    tracked->reference = reference.id;
    tracked->trajectory = trajectory;
    return tracked;
  }

  /// A frame that is no newer than the last one was tracked again: its pose is better now, the map has it already.
  MapperOutput revise(const TrackedFrameConstPtr& frame) {
    if (!frame->tracked() || frame->reference.map_id != map_->id()) return {};
    store_.addFrame(*frame);
    if (candidate_ && candidate_->frame->sequence == frame->frame->sequence) candidate_ = frame;
    return {};
  }

  MapperOutput refine(const TrackedFrameConstPtr& frame) {
    MapperOutput output;
    output.keyframe = integrate(frame);
    if (output.keyframe) output.reference = reference_;
    return output;
  }

  /// A frame becomes a keyframe once the frame after it has been tracked: the motion on both sides then tells how much
  /// the keyframe itself is blurred, without looking at its blur.
  std::optional<KeyframeReport> integrate(const TrackedFrameConstPtr& frame) {
    store_.addFrame(*frame);
    map_->searchDepths(*frame);
    last_ = {frame->frame->sequence, frame->frame->mid_exposure_ns, frame->trajectory};
    last_keyframe_ = frame->reference.keyframe_id;
    motion_.add(frame->frame->mid_exposure_ns, map_->T_map_camera(*frame), measuredVelocity(*frame));
    const TrackedFrameConstPtr candidate = std::exchange(candidate_, nullptr);
    if (!candidate) {
      if (isNeeded(*frame)) candidate_ = frame;
      return std::nullopt;
    }
    const KeyframeReport report = map_->insertKeyframe(*candidate, motion_.velocityOfMiddle());
    reference_ = map_->makeReference(map_->newestKeyframe());
    store_.makeKeyframe(*candidate, reference_->id.map_id, reference_->id.keyframe_id);
    updateFirstKeyframe();
    return report;
  }

  /// Judged against the newest keyframe: the tracker may still be using an older one.
  bool isNeeded(const TrackedFrame& frame) const {
    ExposureTrajectory in_newest = frame.trajectory;
    in_newest.T_reference_mid = reference_->T_map_reference.inverse() * map_->T_map_camera(frame);
    return keyframe_policy_.takes(*reference_, measureFrame(*reference_, in_newest), frame.brightness);
  }

  /// None where the exposure is unknown or instantaneous, unless a rolling shutter tells.
  static std::optional<Vector6> measuredVelocity(const TrackedFrame& frame) {
    const bool rolling = frame.frame->pyramid.level(0).camera.row_time != 0.0;
    if (!rolling && frame.frame->exposure.value_or(0.0) <= 0.0) return std::nullopt;
    return frame.trajectory.velocity;
  }

  MapperOutput handleLost(const TrackedFrame& frame) {
    const std::int64_t now = frame.frame->mid_exposure_ns;
    if (!lost_since_ns_) lost_since_ns_ = now;
    MapperOutput output;
    if (1e-9 * static_cast<double>(now - *lost_since_ns_) < config_.restart_after_lost) return output;
    forgetMap();
    output.message = "lost for too long: a new map begins";
    return output;
  }

  /// A tracker that goes on without a reference while there is a map was restarted; it is given the current one.
  MapperOutput resend() {
    MapperOutput output;
    if (++frames_without_reference_ % kFramesUntilResend != 0) return output;
    auto copy = std::make_shared<Reference>(*reference_);
    copy->hint = last_;
    copy->hint->trajectory.T_reference_mid = copy->T_map_reference.inverse() *
                                             store_.T_map_keyframe(map_->id(), last_keyframe_) *
                                             last_.trajectory.T_reference_mid;
    reference_ = copy;
    output.reference = reference_;
    output.message = "the tracker has no reference: the current one is sent again";
    return output;
  }

  MapperOutput stale(const TrackedFrame& frame) {
    MapperOutput output;
    output.message = "frame " + std::to_string(frame.frame->sequence) + " was tracked in map " +
                     std::to_string(frame.reference.map_id) + ", which is no more";
    return output;
  }

  MapperConfig config_;
  Initializer initializer_;
  KeyframePolicy keyframe_policy_;
  TrajectoryStore store_;
  CalibrationEstimator calibration_;
  std::unique_ptr<LocalMap> map_;
  ReferenceConstPtr reference_;
  MapId next_map_id_ = 1;
  std::optional<std::int64_t> lost_since_ns_;
  KinematicBlur motion_;
  std::optional<BackwardTracking> backward_;
  ReferenceConstPtr first_keyframe_;  // for the frames before it
  TrackedFrameConstPtr candidate_;    // becomes a keyframe with the next frame
  TrackingHint last_;                 // the newest tracked frame, relative to last_keyframe_
  KeyframeId last_keyframe_ = 0;
  int frames_without_reference_ = 0;
};

Mapper::Mapper(const MapperConfig& config) : impl_(std::make_unique<Impl>(config)) {}
Mapper::~Mapper() = default;
MapperOutput Mapper::process(const TrackedFrameConstPtr& frame) { return impl_->process(frame); }
bool Mapper::doDeferredWork() { return impl_->doDeferredWork(); }
void Mapper::finishDeferredWork() { impl_->finishDeferredWork(); }
void Mapper::reset() { impl_->reset(); }
ReferenceConstPtr Mapper::currentReference() const { return impl_->currentReference(); }
std::vector<TrajectoryEntry> Mapper::trajectory() const { return impl_->store().entries(); }
CalibrationCorrection Mapper::correction() const { return impl_->correction(); }
std::vector<MapPoint> Mapper::points() const { return impl_->points(); }

}  // namespace mba_vo
