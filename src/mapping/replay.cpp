#include "mba_vo/mapping/replay.h"

#include <algorithm>

namespace mba_vo {

Replay::Replay(const MapperConfig& config, const InitialMap& initial, const ExposureTrajectory& start,
               std::int64_t start_ns)
    : tracker_(config.tracker),
      unknown_exposure_(config.tracker.unknown_exposure),
      initial_(initial),
      last_(start),
      last_ns_(start_ns) {}

TrackingGuess Replay::guessFor(const FrameConstPtr& frame) const {
  MotionPrior prior;
  prior.previous = last_;
  prior.dt = 1e-9 * static_cast<double>(frame->mid_exposure_ns - last_ns_);
  const double exposure = frame->exposure.value_or(unknown_exposure_);
  const auto same = [&](const InitialMap::Pose& pose) { return pose.frame->sequence == frame->sequence; };
  const auto known = std::find_if(initial_.poses.begin(), initial_.poses.end(), same);
  if (known != initial_.poses.end() && prior.dt != 0.0) {
    const SE3 T_reference_frame = T_reference_initial_ * known->T_reference_frame;
    prior.previous.velocity = (last_.T_reference_mid.inverse() * T_reference_frame).log() / prior.dt;
  }
  TrackingGuess guess(prior, exposure);
  guess.brightness = brightness_;
  return guess;
}

TrackedFrame Replay::track(const Reference& reference, const FrameConstPtr& frame) {
  TrackedFrame tracked = tracker_.track(reference, frame, guessFor(frame));
  if (!tracked.tracked()) return tracked;
  const double dt = 1e-9 * static_cast<double>(frame->mid_exposure_ns - last_ns_);
  const SE3 T_reference_previous = last_.T_reference_mid;
  last_ = tracked.trajectory;
  if (dt != 0.0) last_.velocity = (T_reference_previous.inverse() * last_.T_reference_mid).log() / dt;
  last_ns_ = frame->mid_exposure_ns;
  brightness_ = tracked.brightness;
  return tracked;
}

void Replay::changeReference(const SE3& T_new_old) {
  last_.T_reference_mid = T_new_old * last_.T_reference_mid;
  T_reference_initial_ = T_new_old * T_reference_initial_;
}

}  // namespace mba_vo
