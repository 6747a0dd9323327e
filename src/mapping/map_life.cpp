#include <utility>

#include "mapper_impl.h"
#include "mba_vo/initialization/initial_exposure.h"
#include "mba_vo/initialization/reference_motion.h"
#include "mba_vo/mapping/initial_frames.h"
#include "mba_vo/mapping/initial_vignette.h"

namespace mba_vo {
namespace {

constexpr int kFramesUntilResend = 15;  // the first reference may still be on its way for a while

}  // namespace

MapperOutput Mapper::Impl::findMap(const TrackedFrame& frame, bool has_time) {
  if (frame.blind || !has_time) {
    recovery_.passOver(frame);
    return {};
  }
  return phase_ == MappingPhase::kLocating ? locate(frame) : initialize(frame.frame);
}

/// Frames that were tracked late come once more.
bool Mapper::Impl::isKnownWithoutMap(const Frame& frame) {
  const bool is_known = newest_without_map_ns_ && frame.mid_exposure_ns <= *newest_without_map_ns_;
  if (!is_known) newest_without_map_ns_ = frame.mid_exposure_ns;
  return is_known;
}

MapperOutput Mapper::Impl::initialize(const FrameConstPtr& frame) {
  MapperOutput output;
  if (isKnownWithoutMap(*frame)) return output;
  if (!calibration_) beginCalibration(frame->correction);
  std::unique_ptr<InitialMap> initial = initializer_.add(withCamera(frame, calibration_->correction()));
  output.residuals = initializer_.residuals();
  output.message = initializer_.reason();
  if (!initial) return output;
  calibration_before_map_ = *calibration_;
  initial_frames_ = initializer_.bufferedFrames();
  if (initial->row_time != 0.0) adoptRowTime(*initial);
  if (config_.tracker.estimate_exposure && !initial->reference->exposureWasTold()) adoptExposure(*initial);
  const BodyMotion motion = referenceMotion(*initial, config_.tracker);
  if (config_.refine_calibration) calibration_->add(linearizeInitialVignette(*initial, calibration_->correction()));
  LocalMap::Place place;
  place.keyframe = next_keyframe_id_;
  map_ = std::make_unique<LocalMap>(config_, next_map_id_++, *initial, motion, place, store_, *calibration_);
  change(MappingEvent::kMapBegins);
  output.message = "map " + std::to_string(map_->id()) + " initialised with " + std::to_string(initial->points.size()) +
                   (initial->metric ? " measured points" : " points");
  begin(std::move(initial), motion);
  initializer_.reset();
  output.reference = reference_;
  return output;
}

void Mapper::Impl::beginCalibration(const CalibrationCorrection& known) {
  using Vignette = CalibrationEstimator::Vignette;
  calibration_.emplace(known, config_.vignette_told ? Vignette::kTold : Vignette::kUnknown);
}

void Mapper::Impl::adoptRowTime(InitialMap& initial) {
  CalibrationCorrection correction = calibration_->correction();
  correction.values(CalibrationCorrection::kReadout) +=
      initial.row_time * initial.reference->pyramid.level(0).camera.height;
  beginCalibration(correction);
  initial.reference = withCamera(initial.reference, correction);
  for (InitialMap::Pose& pose : initial.poses) pose.frame = withCamera(pose.frame, correction);
  for (FrameConstPtr& frame : initial_frames_) frame = withCamera(frame, correction);
}

/// Nobody told it, but a map whose frames are taken for sharp goes wrong from the beginning.
void Mapper::Impl::adoptExposure(InitialMap& initial) {
  const std::optional<ExposureSample> found = initialExposure(initial, config_.tracker);
  if (!found) return;
  const auto adopted = [&](const FrameConstPtr& frame) {
    return withExposure(frame, found->exposure, found->log_sigma);
  };
  initial.reference = adopted(initial.reference);
  for (InitialMap::Pose& pose : initial.poses) pose.frame = adopted(pose.frame);
  for (FrameConstPtr& frame : initial_frames_) frame = adopted(frame);
}

void Mapper::Impl::begin(std::shared_ptr<const InitialMap> initial, const BodyMotion& motion) {
  const FrameConstPtr frame = initial->reference;
  first_keyframe_ns_ = frame->mid_exposure_ns;
  const ExposureTrajectory start{SE3(), motion.velocity, frame->exposure.value_or(config_.tracker.unknown_exposure),
                                 motion.acceleration};
  const std::shared_ptr<Reference> reference = snapshot(ReferenceCause::kMapBegins, map_->newestKeyframe());
  reference->hint = newestOf(*initial, start);
  reference_ = reference;
  integrate(referenceItself(*reference, frame, start), true);
  recovery_.keep(*reference, *frame);
  deblur(frame);
  last_ = *reference->hint;
  selector_.restart(last_.mid_exposure_ns, reference->T_map_reference * last_.trajectory.T_reference_mid);
  deferred_.begin(initial, MotionState(start, frame->mid_exposure_ns), initial_frames_, last_.mid_exposure_ns,
                  reference);
  initial_ = std::move(initial);
}

MapperOutput Mapper::Impl::goAlong() {
  MapperOutput output;
  output.refinement = true;
  const std::shared_ptr<const InitialMap> initial = std::exchange(initial_, nullptr);
  const std::vector<InitialFrame> frames = trackInitialFrames(config_, *initial, *reference_);
  output.initial_frames = static_cast<int>(frames.size());
  for (const InitialFrame& frame : frames) map_->searchDepths(*frame.tracked);
  if (frames.empty()) return output;
  const TrackedFrameConstPtr& newest = frames.back().tracked;
  const KeyframePolicy policy(config_.keyframe);
  if (!policy.takes(*reference_, newest->measures, newest->brightness)) return output;
  if (newest->measures.blur_length_px > config_.window.long_blur_px) return output;
  store_.addFrame(*newest);
  insertKeyframe(newest, frames.back().motion, output);
  return output;
}

MapperOutput Mapper::Impl::giveUp(MapperOutput output) {
  const std::shared_ptr<Reference> last =
      closed("map " + std::to_string(map_->id()) + " was given up: " + health_.doubt());
  const auto bad = static_cast<KeyframeId>(health_.badInARow());
  const bool young = health_.isYoung() || health_.beganWrong();
  if (map_->isMetric() && (young || health_.contradictsDepths())) initializer_.doubtDepths(health_.contradictsDepths());
  store_.forget(map_->id(), young || bad > map_->newestKeyframe() ? 0 : map_->newestKeyframe() + 1 - bad);
  const std::vector<FrameConstPtr> frames = young ? initial_frames_ : std::vector<FrameConstPtr>();
  // It would be found there again, and again be wrong.
  if (young && !config_.localize_only) earlier_.reset();
  loops_.giveUpMap(map_->id());
  forgetMap();
  calibration_ = calibration_before_map_;
  last->correction = calibration_->correction();
  output.message = last->closed_because;
  output.reference = last;
  for (const FrameConstPtr& frame : frames) {
    if (frame->mid_exposure_ns <= first_keyframe_ns_) continue;  // that of the map which failed
    const MapperOutput again = initialize(frame);
    if (!again.reference) continue;
    output.reference = again.reference;
    output.message += "; " + again.message;
    break;
  }
  return output;
}

MapperOutput Mapper::Impl::handleLost(const TrackedFrame& frame, bool has_time) {
  MapperOutput output;
  initial_.reset();
  if (const TrackedFrameConstPtr chosen = selector_.takeNow()) {
    insertKeyframe(chosen, selector_.motion(), output);
    return output;
  }
  if (phase_ == MappingPhase::kRefining) refineNoFurther(output);
  if (phase_ != MappingPhase::kLost) recovery_.update(*map_);
  change(MappingEvent::kFrameLost);
  recovery_.lose(frame);
  // What was found for a frame of the past, or with a keyframe on its way, would come when the tracker is elsewhere.
  const bool knows_newest =
      frame.reference.map_id != map_->id() || frame.reference.keyframe_id >= reference_->id.keyframe_id;
  output.searched = has_time && knows_newest && recovery_.isDue(frame);
  if (output.searched) {
    const auto found = recovery_.search(frame, health_.usualFrameError());
    if (found) return goOnFrom(*found, std::move(output));
  }
  if (!recovery_.isLostForGood()) return output;
  output.reference = closed("lost for too long, no map yet");
  output.message = earlier_ ? "lost for too long: the camera is looked for in the map that was loaded"
                            : "lost for too long: a new map begins";
  if (earlier_ && !config_.localize_only) {
    if (auto grown = mapAsCorrected(loops_.corrected(store_))) earlier_ = std::move(grown);
  }
  if (earlier_) {
    loops_.forgetMaps();
  } else {
    loops_.leaveMap(recovery_.archive());
  }
  forgetMap();
  return output;
}

MapperOutput Mapper::Impl::goOnFrom(const Relocalizer::Found& found, MapperOutput output) {
  const bool begins = phase_ == MappingPhase::kLocating;
  const bool departed = begins || !map_->has(found.keyframe);
  if (begins) health_.trustBeginning();
  if (departed) {
    if (!begins) loops_.changeWindow(*map_, found.keyframe, store_);
    if (begins) calibration_before_map_ = *calibration_;
    map_ = recovery_.windowAt(found, begins ? identityOfEarlierMap() : map_->identity(), store_, *calibration_);
    store_.continueFrom(map_->id(), map_->newestKeyframe(), found.keyframe);
  }
  change(begins ? MappingEvent::kMapBegins : MappingEvent::kFoundAgain);
  const KeyframeId keyframe = departed ? map_->newestKeyframe() : found.keyframe;
  const auto cause = begins ? ReferenceCause::kMapBegins : ReferenceCause::kFoundAgain;
  const std::shared_ptr<Reference> reference = snapshot(cause, keyframe, health_.doubt());
  reference->hint = found.hint;
  reference_ = reference;
  if (departed) deblur(found.keyframe_frame);
  last_ = found.hint;
  last_keyframe_ = keyframe;
  selector_.restart(last_.mid_exposure_ns, reference->T_map_reference * last_.trajectory.T_reference_mid);
  output.reference = reference_;
  output.message = begins ? "found in the map that was loaded, as map " + std::to_string(map_->id()) + ", by keyframe "
                          : "found again by keyframe ";
  output.message += std::to_string(found.keyframe);
  return output;
}

MapperOutput Mapper::Impl::resend() {
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

MapperOutput Mapper::Impl::stale(const TrackedFrame& frame) {
  MapperOutput output;
  output.message = "frame " + std::to_string(frame.frame->sequence) + " was tracked in map " +
                   std::to_string(frame.reference.map_id) + ", which is no more";
  return output;
}

std::shared_ptr<Reference> Mapper::Impl::closed(const std::string& reason) const {
  auto last = std::make_shared<Reference>(*reference_);
  last->cause = ReferenceCause::kMapClosed;
  last->closed_because = reason;
  return last;
}

void Mapper::Impl::reset() {
  if (map_) deferred_.finish(*map_, store_);
  abandonMap();
}

void Mapper::Impl::abandonMap() {
  loops_.forgetMaps();
  forgetMap();
  next_keyframe_id_ = 0;
  calibration_.reset();
  initializer_.trustDepths();
}

void Mapper::Impl::forgetMap() {
  change(MappingEvent::kMapClosed);
  if (map_) next_keyframe_id_ = map_->newestKeyframe() + 1;
  refining_.reset();
  initial_.reset();
  map_.reset();
  reference_.reset();
  initializer_.reset();
  newest_without_map_ns_.reset();
  health_.reset();
  recovery_.reset();
  deblurring_.forgetMap();
  initial_frames_.clear();
  selector_.reset();
  deferred_.reset();
  last_ = {};
  frames_without_reference_ = 0;
  if (earlier_) lookInEarlierMap();
}

}  // namespace mba_vo
