#pragma once

#include "mba_vo/simulation/simulation_config.h"

namespace mba_vo {

/// How long the shutter is open, and how much the sensor amplifies, from image to image.
class ExposureProgramme {
 public:
  explicit ExposureProgramme(const SimulationConfig& config);

  /// Exposure time of an image taken at t [s].
  double exposure(double t) const;
  /// Amplification by the sensor; 1 without automatic gain, and with it at the exposure time of the configuration.
  double gain(double t) const;
  /// Light times exposure times gain; 1 at the configuration's exposure time without gain.
  double brightness(double t) const;

 private:
  double reference_;        // [s]
  double shortest_ = 0.0;   // [s]
  double longest_ = 0.0;    // [s]; 0 = always the reference
  double frequency_ = 0.0;  // [rad/s]
  bool auto_gain_ = false;
  double log_error_ = 0.0;  // largest of the automatic gain
  double phase_[3] = {};    // of the exposure and of the two waves of the gain's error [rad]
};

}  // namespace mba_vo
