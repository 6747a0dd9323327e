#include "mba_vo/odometry/odometry.h"

#include <chrono>
#include <limits>
#include <stdexcept>

namespace mba_vo {
namespace {

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

}  // namespace

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

void Odometry::trackWaiting(OdometryResult& result, bool at_end) {
  while (tracking_.reference()) {
    takeDueReferences(at_end ? std::numeric_limits<std::uint64_t>::max() : nextFrame());
    if (const TrackedFrameConstPtr late = tracking_.trackWaiting(!at_end)) {
      result.late.push_back(late);
      map(late, nextFrame() - 1, result);
    } else if (tracking_.waitingFrames() == 0 || !takeDueReferences(frames_)) {
      return;  // done, or held for a keyframe that is not due even by now
    }
  }
}

void Odometry::map(const TrackedFrameConstPtr& tracked, std::uint64_t frame, OdometryResult& result) {
  const Clock::time_point begin = Clock::now();
  result.mapping.push_back(mapper_.process(tracked));
  while (mapper_.doDeferredWork()) {
  }
  result.mapping_ms += millisecondsSince(begin);
  const ReferenceConstPtr& reference = result.mapping.back().reference;
  // Without delay the very next frame has it.
  if (reference) pending_.push_back({frame + static_cast<std::uint64_t>(reference_delay_frames_) + 1, reference});
}

OdometryResult Odometry::finish() {
  OdometryResult result;
  trackWaiting(result, true);
  const Clock::time_point begin = Clock::now();
  mapper_.finishDeferredWork();
  result.mapping_ms += millisecondsSince(begin);
  return result;
}

void Odometry::reset() {
  mapper_.finishDeferredWork();
  tracking_.reset();
  mapper_.reset();
  pending_.clear();
}

OdometryResult Odometry::process(const FrameConstPtr& frame) {
  OdometryResult result;
  if (!tracking_.reference()) takeDueReferences(frames_);
  trackWaiting(result, false);
  result.tracked = tracking_.process(frame);
  map(result.tracked, frames_, result);
  ++frames_;
  return result;
}

}  // namespace mba_vo
