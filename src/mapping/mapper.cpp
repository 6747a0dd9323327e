#include "mba_vo/mapping/mapper.h"

#include <utility>

#include "mba_vo/mapping/deferred_tracking.h"
#include "mba_vo/mapping/keyframe_selector.h"
#include "mba_vo/mapping/recovery.h"

namespace mba_vo {
namespace {

constexpr int kFramesUntilResend = 15;  // the first reference may still be on its way for a while

MapperOutput saying(const std::string& message) { return {nullptr, std::nullopt, std::nullopt, message}; }

}  // namespace

class Mapper::Impl {
 public:
  Impl(const MapperConfig& config, DraftCallback on_draft, std::shared_ptr<const Deblurrer> deblurrer)
      : config_(config),
        on_draft_(std::move(on_draft)),
        initializer_(config.initializer, config.depth_sensor),
        selector_(config.keyframe),
        calibration_(config.start_correction),
        health_(config.health),
        recovery_(config),
        deferred_(config),
        deblurring_(config, std::move(deblurrer)) {}

  MapperOutput process(const TrackedFrameConstPtr& frame, bool has_time) {
    if (!map_) return frame->blind || !has_time ? MapperOutput() : initialize(frame->frame);
    if (frame->frame->mid_exposure_ns <= last_.mid_exposure_ns) return revise(frame);
    // A tracker that was lost for so long that it gave up its reference reports INITIALIZING.
    if (frame->status == TrackingStatus::kLost || (recovery_.isLost() && !frame->tracked())) return handleLost(*frame);
    if (!frame->tracked()) return frame->blind ? MapperOutput() : resend();
    if (frame->reference.map_id != map_->id()) return stale(*frame);
    recovery_.find();
    frames_without_reference_ = 0;
    health_.addFrame(frame->pixel_error);
    if (frame->provisional) {
      store_.addFrame(*frame);
      return {};
    }
    return refine(frame, has_time);
  }

  bool doDeferredWork() { return map_ && deferred_.doNext(*map_, store_); }

  std::vector<TrajectoryEntry> finishedTrajectory() const {
    if (!map_) return store_.entries();
    TrajectoryStore store = store_;
    DeferredTracking deferred = deferred_;
    deferred.finish(*map_, store);
    return store.entries();
  }

  void reset() {
    if (map_) deferred_.finish(*map_, store_);
    abandonMap();
  }

  void abandonMap() {
    forgetMap();
    calibration_ = CalibrationEstimator(config_.start_correction);
    initializer_.trustDepths();
  }

  void forgetMap() {
    map_.reset();
    reference_.reset();
    initializer_.reset();
    newest_initializing_ns_.reset();
    health_.reset();
    recovery_.reset();
    deblurring_.forgetMap();
    initial_frames_.clear();
    selector_.reset();
    deferred_.reset();
    last_ = {};
    frames_without_reference_ = 0;
  }

  ReferenceConstPtr currentReference() const { return reference_; }
  const CalibrationCorrection& correction() const { return calibration_.correction(); }
  const TrajectoryStore& store() const { return store_; }
  std::vector<MapPoint> points() const { return map_ ? map_->points() : std::vector<MapPoint>(); }
  DeblurCounts deblurCounts() const { return deblurring_.counts(); }

 private:
  MapperOutput initialize(const FrameConstPtr& frame) {
    MapperOutput output;
    // Frames that were tracked late come once more.
    if (newest_initializing_ns_ && frame->mid_exposure_ns <= *newest_initializing_ns_) return output;
    newest_initializing_ns_ = frame->mid_exposure_ns;
    std::unique_ptr<InitialMap> initial = initializer_.add(frame);
    if (!initial) return saying(initializer_.reason());
    const Vector6 velocity = referenceVelocity(*initial);
    calibration_before_map_ = calibration_;
    map_ = std::make_unique<LocalMap>(config_, next_map_id_++, *initial, velocity, LocalMap::Place(), store_,
                                      calibration_);
    output.message = "map " + std::to_string(map_->id()) + " initialised with " +
                     std::to_string(initial->points.size()) + (initial->metric ? " measured points" : " points");
    initial_frames_ = initializer_.bufferedFrames();
    reference_ = begin(std::move(initial), velocity);
    initializer_.reset();
    output.reference = reference_;
    return output;
  }

  /// The map is wrong. Its last poses are forgotten, all of them if it has only just begun; the tracker is told to
  /// leave it. What a young map was made of may hold a better one.
  MapperOutput giveUp(MapperOutput output) {
    const std::shared_ptr<Reference> last =
        closed("map " + std::to_string(map_->id()) + " was given up: " + health_.doubt());
    const auto bad = static_cast<KeyframeId>(health_.badInARow());
    const bool young = health_.isYoung();
    if (map_->isMetric() && (young || health_.contradictsDepths()))
      initializer_.doubtDepths(health_.contradictsDepths());
    store_.forget(map_->id(), young || bad > map_->newestKeyframe() ? 0 : map_->newestKeyframe() + 1 - bad);
    const std::vector<FrameConstPtr> frames = young ? initial_frames_ : std::vector<FrameConstPtr>();
    const std::int64_t failed_ns = first_keyframe_ns_;
    forgetMap();
    calibration_ = calibration_before_map_;
    last->correction = calibration_.correction();
    output.message = last->closed_because;
    output.reference = last;
    for (const FrameConstPtr& frame : frames) {
      if (frame->mid_exposure_ns <= failed_ns) continue;
      const MapperOutput again = initialize(frame);
      if (!again.reference) continue;
      output.reference = again.reference;
      output.message += "; " + again.message;
      break;
    }
    return output;
  }

  /// The first reference, with a hint about the newest frame whose pose the initialiser knows: the tracker goes on from
  /// there. Those that came before are tracked, for the trajectory, when there is time.
  ReferenceConstPtr begin(std::unique_ptr<InitialMap> initial, const Vector6& velocity) {
    const FrameConstPtr frame = initial->reference;
    first_keyframe_ns_ = frame->mid_exposure_ns;
    const ExposureTrajectory start{SE3(), velocity, frame->exposure.value_or(config_.tracker.unknown_exposure)};
    const std::shared_ptr<Reference> reference = snapshot(ReferenceCause::kMapBegins, map_->newestKeyframe());
    reference->hint = newestOf(*initial, start);
    reference_ = reference;
    integrate(referenceItself(*reference, frame, start), true);
    last_ = *reference->hint;
    selector_.restart(last_.mid_exposure_ns, reference->T_map_reference * last_.trajectory.T_reference_mid);
    deferred_.begin(std::move(initial), MotionState(start, frame->mid_exposure_ns), initial_frames_,
                    last_.mid_exposure_ns, reference_);
    recovery_.keep(*reference_, *frame, *map_);
    deblur(frame);
    return reference;
  }

  /// A frame that is no newer than the last one was tracked again: its pose is better now, the map has it already.
  MapperOutput revise(const TrackedFrameConstPtr& frame) {
    if (!frame->tracked() || frame->reference.map_id != map_->id()) return {};
    store_.addFrame(*frame);
    selector_.revise(frame);
    deblurring_.remember(frame);
    deferred_.add(frame);
    return {};
  }

  MapperOutput refine(const TrackedFrameConstPtr& frame, bool has_time) {
    MapperOutput output;
    takeSharpKeyframe(output);
    output.keyframe = integrate(frame, has_time);
    deblurring_.beginNext(*map_, frame->frame->mid_exposure_ns);
    return output.keyframe ? withKeyframe(std::move(output)) : output;
  }

  /// After a keyframe has been inserted.
  MapperOutput withKeyframe(MapperOutput output) {
    output.reference = reference_;
    if (!health_.isYoung()) initial_frames_.clear();
    return health_.isWrong() ? giveUp(std::move(output)) : output;
  }

  /// The tracker is given the sharp image if it is using the blurred one.
  void takeSharpKeyframe(MapperOutput& output) {
    const auto& sharp = output.sharp_keyframe = deblurring_.takeReady(*map_, recovery_.archive());
    if (!sharp || !sharp->in_map || sharp->keyframe_id != reference_->id.keyframe_id) return;
    reference_ = snapshot(ReferenceCause::kSharperImage, reference_->id.keyframe_id, health_.doubt());
    output.reference = reference_;
  }

  std::optional<KeyframeReport> integrate(const TrackedFrameConstPtr& frame, bool has_time) {
    store_.addFrame(*frame);
    if (has_time) map_->searchDepths(*frame);
    deblurring_.remember(frame);
    deferred_.add(frame);
    last_ = {frame->frame->sequence, frame->frame->mid_exposure_ns, frame->trajectory};
    last_keyframe_ = frame->reference.keyframe_id;
    const TrackedFrameConstPtr chosen = selector_.add(frame, map_->T_map_camera(*frame), *reference_);
    return chosen ? std::optional(insertKeyframe(chosen)) : std::nullopt;
  }

  KeyframeReport insertKeyframe(const TrackedFrameConstPtr& chosen) {
    KeyframeReport report = map_->insertKeyframe(*chosen, selector_.velocity());
    if (on_draft_) on_draft_(snapshot(ReferenceCause::kKeyframe, map_->newestKeyframe(), health_.doubt()));
    map_->refineWindow(report);
    const std::shared_ptr<Reference> reference = snapshot(ReferenceCause::kKeyframe, map_->newestKeyframe());
    report.error_px = keyframeError(report.rms, *reference);
    health_.addKeyframe(report.error_px);
    health_.addDepths(report.depths);
    reference->doubt = health_.doubt();
    reference_ = reference;
    recovery_.keep(*reference_, *chosen->frame, *map_);
    deblur(chosen->frame, chosen->trajectory.acceleration, chosen->trajectory.velocity);
    store_.makeKeyframe(*chosen, reference_->id.map_id, reference_->id.keyframe_id);
    deferred_.update(*map_);
    return report;
  }

  /// The newest keyframe, made of this frame.
  void deblur(const FrameConstPtr& frame, const Vector6& acceleration = Vector6::Zero(),
              const std::optional<Vector6>& measured_velocity = std::nullopt) {
    const ExposureTrajectory motion{SE3(), reference_->velocity, frame->exposure.value_or(0.0), acceleration};
    deblurring_.offer(*map_, *reference_, frame, motion, measured_velocity);
  }

  MapperOutput handleLost(const TrackedFrame& frame) {
    MapperOutput output;
    if (const TrackedFrameConstPtr chosen = selector_.takeNow()) {
      output.keyframe = insertKeyframe(chosen);
      return withKeyframe(std::move(output));
    }
    if (const auto found = recovery_.lose(frame, health_.usualFrameError())) return goOnFrom(*found);
    if (!recovery_.isLostForGood()) return output;
    output.reference = closed("lost for too long, no map yet");
    output.message = "lost for too long: a new map begins";
    forgetMap();
    return output;
  }

  /// Of a keyframe in the window, for the tracker.
  std::shared_ptr<Reference> snapshot(ReferenceCause cause, KeyframeId keyframe, const std::string& doubt = {}) {
    std::shared_ptr<Reference> reference = map_->makeReference(keyframe, doubt);
    reference->cause = cause;
    reference->id.revision = revision_++;
    return reference;
  }

  /// Tells the tracker to leave the map.
  std::shared_ptr<Reference> closed(const std::string& reason) const {
    auto last = std::make_shared<Reference>(*reference_);
    last->cause = ReferenceCause::kMapClosed;
    last->closed_because = reason;
    return last;
  }

  /// The camera was found by a keyframe. If that has left the window, a new window begins with it.
  MapperOutput goOnFrom(const Relocalizer::Found& found) {
    const bool departed = !map_->has(found.keyframe);
    if (departed) map_ = recovery_.windowAt(found, *map_, store_, calibration_);
    const KeyframeId keyframe = departed ? map_->newestKeyframe() : found.keyframe;
    const std::shared_ptr<Reference> reference = snapshot(ReferenceCause::kFoundAgain, keyframe, health_.doubt());
    reference->hint = found.hint;
    reference_ = reference;
    if (departed) deblur(found.keyframe_frame);
    last_ = found.hint;
    last_keyframe_ = keyframe;
    selector_.restart(last_.mid_exposure_ns, reference->T_map_reference * last_.trajectory.T_reference_mid);
    MapperOutput output;
    output.reference = reference_;
    output.message = "found again by keyframe " + std::to_string(found.keyframe);
    return output;
  }

  /// A tracker that goes on without a reference while there is a map was restarted; it is given the current one.
  MapperOutput resend() {
    MapperOutput output;
    if (++frames_without_reference_ % kFramesUntilResend != 0) return output;
    auto copy = std::make_shared<Reference>(*reference_);
    copy->cause = ReferenceCause::kSentAgain;
    copy->hint = last_;
    copy->hint->trajectory.T_reference_mid = copy->T_map_reference.inverse() *
                                             store_.T_map_keyframe(map_->id(), last_keyframe_) *
                                             last_.trajectory.T_reference_mid;
    reference_ = copy;
    output.reference = reference_;
    output.message = "the tracker has no reference: the current one is sent again";
    return output;
  }

  static MapperOutput stale(const TrackedFrame& frame) {
    return saying("frame " + std::to_string(frame.frame->sequence) + " was tracked in map " +
                  std::to_string(frame.reference.map_id) + ", which is no more");
  }

  MapperConfig config_;
  DraftCallback on_draft_;  // may be empty
  Initializer initializer_;
  KeyframeSelector selector_;
  TrajectoryStore store_;
  CalibrationEstimator calibration_;
  CalibrationEstimator calibration_before_map_;  // what a wrong map says about it is not believed
  std::unique_ptr<LocalMap> map_;
  ReferenceConstPtr reference_;
  MapId next_map_id_ = 1;
  MapHealth health_;
  Recovery recovery_;
  DeferredTracking deferred_;
  KeyframeDeblurring deblurring_;
  std::optional<std::int64_t> newest_initializing_ns_;  // of the frames given to the initialiser
  std::vector<FrameConstPtr> initial_frames_;           // that the initialiser had when the map began
  std::int64_t first_keyframe_ns_ = 0;
  TrackingHint last_;  // the newest tracked frame, relative to last_keyframe_
  KeyframeId last_keyframe_ = 0;
  int frames_without_reference_ = 0;
  std::uint32_t revision_ = 0;  // of the next snapshot
};

Mapper::Mapper(const MapperConfig& config, DraftCallback on_draft, std::shared_ptr<const Deblurrer> deblurrer)
    : impl_(std::make_unique<Impl>(config, std::move(on_draft), std::move(deblurrer))) {}
Mapper::~Mapper() = default;
MapperOutput Mapper::process(const TrackedFrameConstPtr& frame, bool has_time) {
  return impl_->process(frame, has_time);
}
bool Mapper::doDeferredWork() { return impl_->doDeferredWork(); }
std::vector<TrajectoryEntry> Mapper::finishedTrajectory() const { return impl_->finishedTrajectory(); }
void Mapper::reset() { impl_->reset(); }
void Mapper::abandonMap() { impl_->abandonMap(); }
ReferenceConstPtr Mapper::currentReference() const { return impl_->currentReference(); }
std::vector<TrajectoryEntry> Mapper::trajectory() const { return impl_->store().entries(); }
CalibrationCorrection Mapper::correction() const { return impl_->correction(); }
std::vector<MapPoint> Mapper::points() const { return impl_->points(); }
DeblurCounts Mapper::deblurCounts() const { return impl_->deblurCounts(); }

}  // namespace mba_vo
