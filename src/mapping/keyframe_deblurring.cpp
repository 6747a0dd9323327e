#include "mba_vo/mapping/keyframe_deblurring.h"

#include <utility>

#include "mba_vo/tracking/frame_measures.h"

namespace mba_vo {

KeyframeDeblurring::KeyframeDeblurring(const MapperConfig& config, std::shared_ptr<const Deblurrer> deblurrer)
    : config_(config), for_display_(config.deblur.method == "none" && !deblurrer) {
  if (for_display_) {
    config_.deblur.method = "trajectory";
  } else {
    begin(deblurrer ? std::move(deblurrer) : makeDeblurrer(config.deblur));
  }
}

void KeyframeDeblurring::begin(std::shared_ptr<const Deblurrer> deblurrer) {
  queue_.emplace(config_.deblur_queue, std::move(deblurrer), config_.deterministic);
  if (config_.deblur.method == "trajectory" && config_.deblur.trajectory.frames > 1) neighbours_.emplace();
}

void KeyframeDeblurring::setWatched(bool watched) {
  if (watched_ == watched) return;
  watched_ = watched;
  if (!for_display_) return;
  if (!watched) return forgetMap();
  if (!queue_) begin(makeDeblurrer(config_.deblur));
}

void KeyframeDeblurring::remember(const TrackedFrameConstPtr& frame) {
  if (neighbours_ && !isIdle()) neighbours_->add(frame);
}

void KeyframeDeblurring::offer(const LocalMap& map, const Reference& keyframe, const FrameConstPtr& frame,
                               const ExposureTrajectory& motion, const std::optional<Vector6>& measured_velocity) {
  if (isIdle() || (frame->exposure && !(*frame->exposure > 0.0))) return;
  DeblurTask task;
  task.keyframe = keyframe.id.keyframe_id;
  task.blur_px = measureFrame(keyframe, motion).blur_length_px;
  task.input.image = keyframe.pyramid;
  task.input.sequence = frame->sequence;
  task.input.motion = motion;
  task.input.other_velocity = measured_velocity;
  for (const ReferencePoint& p : keyframe.points) task.input.depths.push_back({p.pixel, p.inverse_depth});
  if (neighbours_) task.input.neighbours = neighbours_->around(keyframe, frame->sequence, map);
  queue_->offer(std::move(task));
}

std::optional<SharpKeyframe> KeyframeDeblurring::takeReady(LocalMap& map, KeyframeArchive& archive) {
  if (!queue_) return std::nullopt;
  const std::optional<DeblurredKeyframe> ready = queue_->take([&](KeyframeId id) { return map.has(id); });
  if (!ready) return std::nullopt;
  SharpKeyframe sharp{ready->keyframe, map.frame(ready->keyframe), ready->result.image, false};
  if (for_display_) return sharp;
  if (config_.deblur.check && !map.explainsAsWell(sharp.keyframe_id, sharp.image)) return sharp;
  map.replaceImage(sharp.keyframe_id, sharp.image);
  archive.replace(*map.makeReference(sharp.keyframe_id), *sharp.frame);
  sharp.in_map = true;
  ++in_map_;
  return sharp;
}

void KeyframeDeblurring::beginNext(const LocalMap& map, std::int64_t now_ns) {
  if (queue_) queue_->begin(now_ns, [&](KeyframeId id) { return map.has(id); });
}

void KeyframeDeblurring::forgetMap() {
  if (queue_) queue_->clear();
  if (neighbours_) neighbours_->clear();
}

DeblurCounts KeyframeDeblurring::counts() const {
  if (!queue_) return {};
  DeblurCounts counts = queue_->counts();
  counts.in_map = in_map_;
  return counts;
}

}  // namespace mba_vo
