#include "mba_vo/capture/exposure_regulator.h"

#include <algorithm>
#include <cmath>

namespace mba_vo {
namespace {

// Mean of an ordinary scene in grey values with gamma; within the band nothing is changed, for a change costs the
// exposures of some images.
constexpr double kTarget = 0.42, kDarkest = 0.3, kBrightest = 0.56;
constexpr double kLargestStep = 2.0;  // of the exposure; a black or white image does not say how far it is off
constexpr int kGainSteps = 12;        // from one end to the other; how gains count differs between cameras

}  // namespace

ExposureRegulator::ExposureRegulator(const Limits& limits)
    : limits_(limits), setting_{limits.max_exposure, limits.min_gain} {}

std::optional<ExposureRegulator::Setting> ExposureRegulator::update(double level) {
  if (level > kDarkest && level < kBrightest) return std::nullopt;
  const Setting before = setting_;
  const bool brighter = level <= kDarkest;
  const bool by_gain = brighter ? setting_.exposure >= limits_.max_exposure : setting_.gain > limits_.min_gain;
  if (by_gain) {
    const int step = std::max(1, (limits_.max_gain - limits_.min_gain) / kGainSteps);
    setting_.gain = std::clamp(setting_.gain + (brighter ? step : -step), limits_.min_gain, limits_.max_gain);
  } else {
    const double factor = std::clamp(kTarget / std::max(level, 1e-3), 1.0 / kLargestStep, kLargestStep);
    setting_.exposure = std::clamp(factor * setting_.exposure, limits_.min_exposure, limits_.max_exposure);
  }
  if (setting_.exposure == before.exposure && setting_.gain == before.gain) return std::nullopt;
  return setting_;
}

}  // namespace mba_vo
