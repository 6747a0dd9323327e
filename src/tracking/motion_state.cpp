#include "mba_vo/tracking/motion_state.h"

#include <algorithm>
#include <cmath>

namespace mba_vo {
namespace {

/// True if nobody told the exposure, or the blur is too short to measure a velocity by; a rolling shutter always tells.
bool velocityUnobserved(const TrackedFrame& tracked) {
  const Frame& frame = *tracked.frame;
  if (frame.pyramid.levels() > 0 && frame.pyramid.level(0).camera.row_time != 0.0) return false;
  return !frame.exposureWasTold() || *frame.exposure <= 0.0 || tracked.xi_prior_limited;
}

}  // namespace

void MotionState::update(const TrackedFrame& tracked) {
  const double dt = 1e-9 * static_cast<double>(tracked.frame->mid_exposure_ns - last_ns_);
  const ExposureTrajectory previous = last_;
  last_ = tracked.trajectory;
  last_ns_ = tracked.frame->mid_exposure_ns;
  acceleration_.setZero();
  if (dt == 0.0 || std::abs(dt) > kLongestPrediction) return;
  const Vector6 mean_velocity = (previous.T_reference_mid.inverse() * last_.T_reference_mid).log() / dt;
  // Where the exposure does not tell the velocity, the mean since the previous frame serves.
  if (velocityUnobserved(tracked)) last_.velocity = mean_velocity;
  acceleration_ = (last_.velocity - previous.velocity) / dt;
}

MotionPrior MotionState::priorAt(std::int64_t mid_exposure_ns) const {
  MotionPrior prior;
  prior.previous = last_;
  prior.acceleration = acceleration_;
  prior.dt =
      std::clamp(1e-9 * static_cast<double>(mid_exposure_ns - last_ns_), -kLongestPrediction, kLongestPrediction);
  return prior;
}

}  // namespace mba_vo
