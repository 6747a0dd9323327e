#include "mba_vo/odometry/brightness_state.h"

#include <cmath>

namespace mba_vo {
namespace {

constexpr double kClearChange = 0.4;  // of the log of the contrast

}  // namespace

AffineBrightness BrightnessState::expectedAt(double contrast_now) const {
  if (!(contrast > 0.0) || !(contrast_now > 0.0)) return brightness;
  const double change = std::log(contrast_now / contrast);
  if (std::abs(change) < kClearChange) return brightness;
  return {brightness.a + change, std::exp(change) * brightness.b};
}

}  // namespace mba_vo
