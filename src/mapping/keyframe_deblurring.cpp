#include "mba_vo/mapping/keyframe_deblurring.h"

#include <utility>

#include "mba_vo/tracking/frame_measures.h"

namespace mba_vo {

KeyframeDeblurring::KeyframeDeblurring(const MapperConfig& config, std::shared_ptr<const Deblurrer> deblurrer) {
  if (!deblurrer) {
    if (config.deblur.method == "none") return;
    deblurrer = makeDeblurrer(config.deblur);
  }
  queue_.emplace(config.deblur_queue, std::move(deblurrer), config.deterministic);
}

void KeyframeDeblurring::offer(const Reference& keyframe, const FrameConstPtr& frame, const ExposureTrajectory& motion,
                               const std::optional<Vector6>& measured_velocity) {
  if (!queue_ || (frame->exposure && !(*frame->exposure > 0.0))) return;
  DeblurTask task;
  task.keyframe = keyframe.id.keyframe_id;
  task.blur_px = measureFrame(keyframe, motion).blur_length_px;
  task.input.image = keyframe.pyramid;
  task.input.sequence = frame->sequence;
  task.input.motion = motion;
  task.input.other_velocity = measured_velocity;
  for (const ReferencePoint& p : keyframe.points) task.input.depths.push_back({p.pixel, p.inverse_depth});
  queue_->offer(std::move(task));
}

std::optional<SharpKeyframe> KeyframeDeblurring::takeReady(LocalMap& map, KeyframeArchive& archive) {
  if (!queue_) return std::nullopt;
  const std::optional<DeblurredKeyframe> ready = queue_->take([&](KeyframeId id) { return map.has(id); });
  if (!ready) return std::nullopt;
  map.replaceImage(ready->keyframe, ready->result.image);
  const SharpKeyframe sharp{ready->keyframe, map.frame(ready->keyframe), ready->result.image};
  archive.replace(*map.makeReference(sharp.keyframe_id), *sharp.frame);
  return sharp;
}

void KeyframeDeblurring::beginNext(const LocalMap& map, std::int64_t now_ns) {
  if (queue_) queue_->begin(now_ns, [&](KeyframeId id) { return map.has(id); });
}

void KeyframeDeblurring::forgetMap() {
  if (queue_) queue_->clear();
}

}  // namespace mba_vo
