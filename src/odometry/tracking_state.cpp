#include "mba_vo/odometry/tracking_state.h"

#include <cmath>

#include "mba_vo/image/image_content.h"

namespace mba_vo {
namespace {

constexpr double kClearChange = 0.4;  // of the log of the contrast

}  // namespace

TrackingState::TrackingState(const Reference& reference)
    : motion_(reference.hint->trajectory, reference.hint->mid_exposure_ns),
      brightness_(reference.brightness),
      contrast_(contrast(*reference.pyramid)) {}

TrackingGuess TrackingState::guessFor(const Frame& frame, double unknown_exposure) const {
  TrackingGuess guess(motion_.priorAt(frame.mid_exposure_ns), frame.exposure.value_or(unknown_exposure));
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
