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

void Odometry::adoptDueReferences(OdometryResult& result) {
  while (!pending_.empty() && pending_.front().due_frame <= frames_) {
    const ReferenceConstPtr reference = pending_.front().reference;
    pending_.pop_front();
    for (const TrackedFrameConstPtr& late : tracking_.adopt(reference)) {
      result.late.push_back(late);
      map(late, result);
    }
  }
}

void Odometry::map(const TrackedFrameConstPtr& tracked, OdometryResult& result) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  result.mapping.push_back(mapper_.process(tracked));
  result.mapping_ms += std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
  const ReferenceConstPtr& reference = result.mapping.back().reference;
  // Without delay the very next frame has it.
  const auto delay = static_cast<std::uint64_t>(reference_delay_frames_) + 1;
  if (reference) pending_.push_back({frames_ + delay, reference});
}

OdometryResult Odometry::process(const FrameConstPtr& frame) {
  OdometryResult result;
  adoptDueReferences(result);
  result.tracked = tracking_.process(frame);
  map(result.tracked, result);
  ++frames_;
  return result;
}

}  // namespace mba_vo
