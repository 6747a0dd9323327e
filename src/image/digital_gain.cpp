#include "mba_vo/image/digital_gain.h"

#include <cmath>

namespace mba_vo {
namespace {

constexpr double kBrightEnough = 48.0;  // [grey levels] mean after the gain; half of what the thresholds were found at
constexpr double kNoisy = 10.0;    // [grey levels] after the gain; above, noise alone makes half of the pixels outliers
constexpr double kLargest = 16.0;  // there is little but noise in what is darker
constexpr double kTooDark = 0.5;   // light that has changed so much suits another gain, if the image is dark
constexpr double kTooBright = 192.0;  // [grey levels] mean after the gain

}  // namespace

bool DigitalGain::suits(double mean) const {
  if (!chosen_) return false;
  const bool too_dark = value_ * mean < kTooDark * kBrightEnough && mean < kTooDark * mean_;
  const bool too_bright = value_ > 1.0 && value_ * mean > kTooBright;
  return !too_dark && !too_bright;
}

void DigitalGain::choose(double mean, double noise) {
  chosen_ = true;
  mean_ = mean;
  value_ = 1.0;
  while (value_ < kLargest && value_ * mean < kBrightEnough && 2.0 * value_ * noise < kNoisy) value_ *= 2.0;
}

void DigitalGain::makeUpFor(double factor) {
  mean_ /= factor;
  value_ *= std::exp2(std::round(std::log2(factor)));
}

}  // namespace mba_vo
