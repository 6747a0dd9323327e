#include "mba_vo/simulation/exposure_programme.h"

#include <cmath>

#include <opencv2/core.hpp>

#include "mba_vo/geometry/angles.h"

namespace mba_vo {
namespace {

// The gain's error swings with two waves that have no common period with the exposure.
constexpr double kErrorFrequency[2] = {1.37, 3.19};  // in units of the exposure's
constexpr double kErrorShare[2] = {0.6, 0.4};

}  // namespace

ExposureProgramme::ExposureProgramme(const SimulationConfig& config)
    : reference_(config.exposure),
      shortest_(config.exposure_min),
      longest_(config.exposure_max),
      frequency_(kTwoPi / config.exposure_period),
      auto_gain_(config.auto_gain),
      log_error_(std::log1p(config.gain_error)) {
  cv::RNG random(0xE4905E0000ULL + static_cast<std::uint64_t>(config.trajectory_seed));
  for (int i = 0; i < 8; ++i) random.next();  // neighbouring seeds start alike
  for (double& phase : phase_) phase = random.uniform(0.0, kTwoPi);
}

double ExposureProgramme::exposure(double t) const {
  if (longest_ <= 0.0) return reference_;
  const double part = 0.5 + 0.5 * std::sin(frequency_ * t + phase_[0]);
  return shortest_ * std::pow(longest_ / shortest_, part);
}

double ExposureProgramme::brightness(double t) const {
  if (!auto_gain_) return longest_ > 0.0 ? exposure(t) / reference_ : 1.0;
  double swing = 0.0;
  for (int i = 0; i < 2; ++i) swing += kErrorShare[i] * std::sin(kErrorFrequency[i] * frequency_ * t + phase_[i + 1]);
  return std::exp(log_error_ * swing);
}

double ExposureProgramme::gain(double t) const {
  if (!auto_gain_) return 1.0;
  return longest_ > 0.0 ? brightness(t) * reference_ / exposure(t) : brightness(t);
}

}  // namespace mba_vo
