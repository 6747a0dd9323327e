#include "mba_vo/odometry/tracking_state.h"

#include <cmath>

#include "mba_vo/image/image_content.h"

namespace mba_vo {
namespace {

constexpr double kClearChange = 0.4;  // of the log of the contrast

/// As if the camera had turned evenly, and as fast as it turned at the end, to where it is now.
void follow(const CameraTurn& turn, MotionPrior& prior) {
  ExposureTrajectory& previous = prior.previous;
  const Eigen::Vector3d way = prior.dt * previous.velocity.head<3>();
  const SE3 T_reference_now = previous.T_reference_mid * SE3(turn.R_from_to, way);
  previous.velocity.head<3>() = turn.R_from_to.conjugate() * previous.velocity.head<3>();
  previous.velocity.tail<3>() = turn.angular_velocity;
  previous.T_reference_mid = T_reference_now * SE3::exp(-prior.dt * previous.velocity);
  prior.acceleration.setZero();
}

}  // namespace

TrackingState::TrackingState(const Reference& reference)
    : motion_(reference.hint->trajectory, reference.hint->mid_exposure_ns),
      brightness_(reference.brightness),
      contrast_(contrast(*reference.pyramid)) {}

TrackingGuess TrackingState::guessFor(const Frame& frame, double unknown_exposure,
                                      const std::optional<CameraTurn>& turn) const {
  MotionPrior prior = motion_.priorAt(frame.mid_exposure_ns);
  if (turn) follow(*turn, prior);
  TrackingGuess guess(prior, frame.exposure.value_or(unknown_exposure));
  guess.brightness = expectedBrightness(contrast(frame.pyramid));
  return guess;
}

void TrackingState::update(const TrackedFrame& tracked) {
  motion_.update(tracked);
  brightness_ = tracked.brightness;
  contrast_ = contrast(tracked.frame->pyramid);
}

AffineBrightness TrackingState::expectedBrightness(double contrast_now) const {
  if (!(contrast_ > 0.0) || !(contrast_now > 0.0)) return brightness_;
  const double change = std::log(contrast_now / contrast_);
  if (std::abs(change) < kClearChange) return brightness_;
  return {brightness_.a + change, std::exp(change) * brightness_.b};
}

}  // namespace mba_vo
