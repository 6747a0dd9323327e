#include "mba_vo/mapping/mapper.h"

#include <algorithm>
#include <utility>

#include "mapper_impl.h"

namespace mba_vo {

Mapper::Impl::Impl(const MapperConfig& config, std::shared_ptr<const Deblurrer> deblurrer)
    : config_(config),
      initializer_(config.initializer, config.depth_sensor, config.refine_calibration),
      selector_(config.keyframe),
      health_(config.health),
      recovery_(config),
      deferred_(config),
      deblurring_(config, std::move(deblurrer)),
      loops_(config) {}

MapperOutput Mapper::Impl::process(const TrackedFrameConstPtr& frame, bool has_time) {
  // The tracker may know a map of a mapper that was there before this one.
  if (!map_) {
    next_map_id_ = std::max(next_map_id_, frame->reference.map_id + 1);
    return findMap(*frame, has_time);
  }
  if (frame->frame->mid_exposure_ns <= last_.mid_exposure_ns) return revise(frame);
  // A tracker that was lost for so long that it gave up its reference reports INITIALIZING.
  const bool was_lost = phase_ == MappingPhase::kLost;
  if (frame->status == TrackingStatus::kLost || (was_lost && !frame->tracked())) return handleLost(*frame, has_time);
  if (!frame->tracked()) return frame->blind ? MapperOutput() : resend();
  if (frame->reference.map_id != map_->id()) return stale(*frame);
  if (was_lost) change(MappingEvent::kFrameTracked);
  recovery_.find();
  frames_without_reference_ = 0;
  health_.addFrame(frame->pixel_error);
  if (health_.beganWrong()) return giveUp({});
  if (frame->provisional) {
    store_.addFrame(*frame);
    return {};
  }
  MapperOutput output;
  takeSharpKeyframe(output);
  output.searched_depths = has_time;
  if (const TrackedFrameConstPtr chosen = integrate(frame, has_time)) {
    insertKeyframe(chosen, selector_.motion(), output);
  }
  deblurring_.beginNext(*map_, frame->frame->mid_exposure_ns);
  return output;
}

MapperOutput Mapper::Impl::revise(const TrackedFrameConstPtr& frame) {
  if (!frame->tracked() || frame->reference.map_id != map_->id()) return {};
  store_.addFrame(*frame);
  selector_.revise(frame);
  deblurring_.remember(frame);
  deferred_.add(frame);
  return {};
}

void Mapper::Impl::takeSharpKeyframe(MapperOutput& output) {
  if (phase_ == MappingPhase::kRefining) return;  // the window is being worked on
  const auto& sharp = output.sharp_keyframe = deblurring_.takeReady(*map_, recovery_.archive());
  if (!sharp || !sharp->in_map || sharp->keyframe_id != reference_->id.keyframe_id) return;
  reference_ = snapshot(ReferenceCause::kSharperImage, reference_->id.keyframe_id, health_.doubt());
  output.reference = reference_;
}

TrackedFrameConstPtr Mapper::Impl::integrate(const TrackedFrameConstPtr& frame, bool has_time) {
  store_.addFrame(*frame);
  if (has_time) map_->searchDepths(*frame);
  deblurring_.remember(frame);
  deferred_.add(frame);
  last_ = {frame->frame->sequence, frame->frame->mid_exposure_ns, frame->trajectory};
  last_keyframe_ = frame->reference.keyframe_id;
  const bool refining = phase_ == MappingPhase::kRefining;
  TrackedFrameConstPtr chosen = selector_.add(frame, map_->T_map_camera(*frame), *reference_, refining);
  if (const auto motion = selector_.takeMotionAfterwards()) map_->reviseNewestMotion(*motion);
  return chosen;
}

void Mapper::Impl::insertKeyframe(const TrackedFrameConstPtr& chosen, const BodyMotion& motion, MapperOutput& output) {
  initial_.reset();  // what leads to a second keyframe is not needed any more
  if (phase_ == MappingPhase::kRefining) refineNoFurther(output);
  change(MappingEvent::kKeyframe);
  refining_ = {chosen, map_->insertKeyframe(*chosen, motion)};
  output.inserted = true;
  output.residuals = refining_->report.activation_residuals;
  output.reference = reference_ = snapshot(ReferenceCause::kKeyframe, map_->newestKeyframe(), health_.doubt());
}

MapperOutput Mapper::Impl::refine() {
  if (initial_) return goAlong();
  MapperOutput output;
  if (phase_ != MappingPhase::kRefining) {
    insertKeyframe(selector_.takeReady(), selector_.motion(), output);
    return output;
  }
  output.refinement = true;
  const bool more = map_->refineWindow(refining_->report);
  output.residuals = map_->evaluatedResiduals();
  if (more) return output;
  finishRefining(true, output);
  output.reference = reference_;
  if (!health_.isYoung()) initial_frames_.clear();
  return health_.isWrong() ? giveUp(std::move(output)) : output;
}

void Mapper::Impl::refineNoFurther(MapperOutput& output) {
  map_->refineWindowNoFurther(refining_->report);
  finishRefining(false, output);
}

void Mapper::Impl::finishRefining(bool refined, MapperOutput& output) {
  output.message = complete(refining_->report, refining_->chosen, refined);
  output.keyframe = std::move(refining_->report);
  refining_.reset();
  change(MappingEvent::kKeyframeRefined);
}

std::string Mapper::Impl::complete(KeyframeReport& report, const TrackedFrameConstPtr& chosen, bool refined) {
  const std::vector<LocalMap::Departed> departed = map_->takeDeparted();
  std::string news = loops_.follow(*map_, departed, store_);
  const std::shared_ptr<Reference> reference = snapshot(ReferenceCause::kKeyframe, map_->newestKeyframe());
  if (refined) {  // else its error is none that the map should be judged by
    report.error_px = keyframeError(report.rms, *reference);
    health_.addKeyframe(report.error_px);
    if (map_->isMetric()) health_.addDepths(report.depths);  // else they are what an earlier window had found
  }
  reference->doubt = health_.doubt();
  reference_ = reference;
  for (const LocalMap::Departed& keyframe : departed) recovery_.update(*keyframe.reference);
  if (!keepsEarlierMap()) recovery_.keep(*reference_, *chosen->frame);
  deblur(chosen->frame, chosen->trajectory.acceleration, chosen->trajectory.velocity);
  store_.makeKeyframe(*chosen, reference_->id.map_id, reference_->id.keyframe_id);
  deferred_.update(*map_);
  return news;
}

void Mapper::Impl::deblur(const FrameConstPtr& frame, const Vector6& acceleration,
                          const std::optional<Vector6>& measured_velocity) {
  const ExposureTrajectory motion{SE3(), reference_->motion.velocity, frame->exposure.value_or(0.0), acceleration};
  deblurring_.offer(*map_, *reference_, frame, motion, measured_velocity);
}

std::shared_ptr<Reference> Mapper::Impl::snapshot(ReferenceCause cause, KeyframeId keyframe, const std::string& doubt) {
  std::shared_ptr<Reference> reference = map_->makeReference(keyframe, doubt);
  reference->cause = cause;
  reference->T_corrected_map = loops_.T_corrected_map();
  reference->id.revision = revision_++;
  return reference;
}

SmoothedTrajectory Mapper::Impl::smoothedTrajectory() const {
  if (!map_) return loops_.smoothed(store_, nullptr);
  TrajectoryStore store = store_;
  DeferredTracking deferred = deferred_;
  deferred.finish(*map_, store);
  return loops_.smoothed(store, map_.get());
}

std::vector<TrajectoryEntry> Mapper::Impl::trajectory() const { return loops_.trajectory(store_); }

std::vector<MapPoint> Mapper::Impl::points() const {
  if (!map_) return {};
  std::vector<MapPoint> points = map_->points();
  const TrajectoryStore::CorrectedKeyframes corrected = loops_.corrected(store_);
  if (corrected.empty()) return points;
  for (MapPoint& point : points) {
    const auto moved = corrected.find({point.map_id, point.keyframe_id});
    if (moved == corrected.end()) continue;
    const SE3 T_map_keyframe = store_.T_map_keyframe(point.map_id, point.keyframe_id);
    point.position_map = moved->second * (T_map_keyframe.inverse() * point.position_map);
  }
  return points;
}

Mapper::Mapper(const MapperConfig& config, std::shared_ptr<const Deblurrer> deblurrer)
    : impl_(std::make_unique<Impl>(config, std::move(deblurrer))) {}
Mapper::~Mapper() = default;
MapperOutput Mapper::process(const TrackedFrameConstPtr& frame, bool has_time) {
  return impl_->process(frame, has_time);
}
bool Mapper::needsRefinement() const { return impl_->needsRefinement(); }
MapperOutput Mapper::refine() { return impl_->refine(); }
void Mapper::watchSharpKeyframes(bool watched) { impl_->watchSharpKeyframes(watched); }
bool Mapper::doDeferredWork() { return impl_->doDeferredWork(); }
SmoothedTrajectory Mapper::smoothedTrajectory() const { return impl_->smoothedTrajectory(); }
void Mapper::reset() { impl_->reset(); }
void Mapper::abandonMap() { impl_->abandonMap(); }
void Mapper::beginIn(const SavedMap& map) { impl_->beginIn(map); }
std::optional<SavedMap> Mapper::savedMap() const { return impl_->savedMap(); }
MappingPhase Mapper::phase() const { return impl_->phase(); }
ReferenceConstPtr Mapper::currentReference() const { return impl_->currentReference(); }
std::vector<TrajectoryEntry> Mapper::trajectory() const { return impl_->trajectory(); }
std::optional<CalibrationCorrection> Mapper::correction() const { return impl_->correction(); }
std::optional<CalibrationCorrection> Mapper::settledCorrection() const { return impl_->settledCorrection(); }
std::vector<MapPoint> Mapper::points() const { return impl_->points(); }
DeblurCounts Mapper::deblurCounts() const { return impl_->deblurCounts(); }
LoopCounts Mapper::loopCounts() const { return impl_->loopCounts(); }

}  // namespace mba_vo
