#include "mba_vo/odometry/odometry.h"

#include <chrono>
#include <stdexcept>

namespace mba_vo {

Odometry::Odometry(const OdometryConfig& config, int reference_delay_frames)
    : tracking_(config), mapper_(config.mapper), reference_delay_frames_(reference_delay_frames) {
  if (reference_delay_frames < 0) {
    throw std::invalid_argument("reference delay of " + std::to_string(reference_delay_frames) +
                                " frames: must be 0 or more");
  }
}

bool Odometry::takeDueReferences(std::uint64_t frame) {
  bool any = false;
  while (!pending_.empty() && pending_.front().due_frame <= frame) {
    any = tracking_.take(pending_.front().reference) || any;
    pending_.pop_front();
  }
  return any;
}

std::uint64_t Odometry::nextFrame() const { return frames_ - tracking_.waitingFrames(); }  // the newest ones wait

void Odometry::trackWaiting(OdometryResult& result) {
  while (tracking_.reference()) {
    takeDueReferences(nextFrame());
    if (const TrackedFrameConstPtr late = tracking_.trackWaiting()) {
      result.late.push_back(late);
      map(late, nextFrame() - 1, result);
    } else if (tracking_.waitingFrames() == 0 || !takeDueReferences(frames_)) {
      return;  // done, or held for a keyframe that is not due even by now
    }
  }
}

void Odometry::map(const TrackedFrameConstPtr& tracked, std::uint64_t frame, OdometryResult& result) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  result.mapping.push_back(mapper_.process(tracked));
  mapper_.doDeferredWork();
  result.mapping_ms += std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
  const ReferenceConstPtr& reference = result.mapping.back().reference;
  // Without delay the very next frame has it.
  if (reference) pending_.push_back({frame + static_cast<std::uint64_t>(reference_delay_frames_) + 1, reference});
}

OdometryResult Odometry::process(const FrameConstPtr& frame) {
  OdometryResult result;
  if (!tracking_.reference()) takeDueReferences(frames_);
  trackWaiting(result);
  result.tracked = tracking_.process(frame);
  map(result.tracked, frames_, result);
  ++frames_;
  return result;
}

}  // namespace mba_vo
