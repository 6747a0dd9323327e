#include "mba_vo/odometry/odometry.h"

#include <chrono>
#include <limits>
#include <stdexcept>

namespace mba_vo {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kUnbounded = std::numeric_limits<std::size_t>::max();  // nothing is ever shed

double now() { return std::chrono::duration<double>(Clock::now().time_since_epoch()).count(); }

}  // namespace

Odometry::Odometry(const OdometryConfig& config, int reference_delay_frames, const PhotometricCalibration& photometric)
    : tracker_({config, photometric, kUnbounded, false}),
      mapper_(config.mapper, kUnbounded),
      reference_delay_frames_(reference_delay_frames) {
  if (reference_delay_frames < 0) {
    throw std::invalid_argument("reference delay of " + std::to_string(reference_delay_frames) +
                                " frames: must be 0 or more");
  }
}

OdometryResult Odometry::process(const CameraImage& image) {
  OdometryResult result;
  if (!tracker_.tracking().reference()) deliverDueReferences(frames_);
  trackWaiting(result, false);
  tracker_.addImage(image, 1e-9 * static_cast<double>(image.mid_exposure_ns));
  return processQueued(std::move(result));
}

OdometryResult Odometry::process(const FrameConstPtr& frame) {
  OdometryResult result;
  if (!tracker_.tracking().reference()) deliverDueReferences(frames_);
  trackWaiting(result, false);
  tracker_.addFrame(frame);
  return processQueued(std::move(result));
}

OdometryResult Odometry::finish() {
  OdometryResult result;
  trackWaiting(result, true);
  return result;
}

void Odometry::reset() {
  tracker_.requestReset();
  trackerStep(false);
  mapper_.reset();
  pending_.clear();
}

OdometryResult Odometry::processQueued(OdometryResult result) {
  tracker_.rest();
  while (tracker_.queuedJobs() > 0) {
    const std::optional<TrackerStep> step = trackerStep(false);
    if (step->began_anew) pending_.clear();
    if (!step->endsImage()) continue;
    result.images.push_back({*step, step->arrival});
    if (!step->message.tracked) continue;
    map(step->message, frames_, result);
    ++frames_;
  }
  return result;
}

bool Odometry::deliverDueReferences(std::uint64_t frame) {
  for (; !pending_.empty() && pending_.front().due_frame <= frame; pending_.pop_front()) {
    tracker_.addReference(pending_.front().message);
  }
  tracker_.adoptReferences();
  return !tracker_.takeAdopted().empty();
}

std::uint64_t Odometry::nextFrame() const { return frames_ - tracker_.tracking().waitingFrames(); }  // the newest wait

void Odometry::trackWaiting(OdometryResult& result, bool at_end) {
  while (tracker_.tracking().reference() && tracker_.queuedJobs() == 0) {
    deliverDueReferences(at_end ? std::numeric_limits<std::uint64_t>::max() : nextFrame());
    if (const std::optional<TrackerStep> late = trackerStep(at_end)) {
      if (!late->message.tracked) continue;
      result.late.push_back(late->message.tracked);
      map(late->message, nextFrame() - 1, result);
    } else if (tracker_.tracking().waitingFrames() == 0 || !deliverDueReferences(frames_)) {
      return;  // done, or held for a keyframe that is not due even by now
    }
  }
}

void Odometry::map(const TrackerMessage& message, std::uint64_t frame, OdometryResult& result) {
  const double begin = now();
  mapper_.addFrame(message);
  while (const std::optional<MapperStep> step = mapperStep()) {
    if (step->isOfFrame()) result.mapping.push_back(step->output);
    // Without delay the very next frame has it. A draft is for those who cannot wait.
    const bool is_draft = !step->output.beginsMap() && mapper_.mapper().needsRefinement();
    if (step->output.reference && !is_draft) {
      pending_.push_back({frame + static_cast<std::uint64_t>(reference_delay_frames_) + 1, step->reference});
    }
  }
  constexpr double kMillisecondsPerSecond = 1e3;
  result.mapping_ms += kMillisecondsPerSecond * (now() - begin);
}

std::optional<TrackerStep> Odometry::trackerStep(bool at_end) {
  const double begin = now();
  std::optional<TrackerStep> step = at_end ? tracker_.finishStep() : tracker_.step();
  if (step) meter_.add(*step, now() - begin);
  return step;
}

std::optional<MapperStep> Odometry::mapperStep() {
  const double begin = now();
  std::optional<MapperStep> step = mapper_.step();
  if (step) meter_.add(*step, now() - begin);
  return step;
}

}  // namespace mba_vo
