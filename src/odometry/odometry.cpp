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

OdometryResult Odometry::process(const FrameConstPtr& frame) {
  using Clock = std::chrono::steady_clock;
  while (!pending_.empty() && pending_.front().due_frame <= frames_) {
    tracking_.adopt(pending_.front().reference);
    pending_.pop_front();
  }
  OdometryResult result;
  result.tracked = tracking_.process(frame);
  const Clock::time_point mapping_begin = Clock::now();
  result.mapping = mapper_.process(result.tracked);
  result.mapping_ms = std::chrono::duration<double, std::milli>(Clock::now() - mapping_begin).count();
  ++frames_;
  if (result.mapping.reference) {
    // Without delay the very next frame has it.
    pending_.push_back({frames_ + static_cast<std::uint64_t>(reference_delay_frames_), result.mapping.reference});
  }
  return result;
}

}  // namespace mba_vo
