#pragma once

#include "mba_vo/window/calibration_system.h"

namespace mba_vo {

/// Corrects the calibration where window after window agrees that it is wrong. A good calibration stays as it is: what
/// the windows then say is small beside its uncertainty.
class CalibrationEstimator {
 public:
  explicit CalibrationEstimator(const CalibrationCorrection& start = {}) : correction_(start) {}

  /// The correction that new images should be made with.
  const CalibrationCorrection& correction() const { return correction_; }

  /// Adds what a window says about errors left by the present correction. True if the correction changed.
  bool add(const CalibrationSystem& system);

 private:
  CalibrationCorrection correction_;
  CalibrationSystem sum_;  // since the correction changed
  int windows_ = 0;        // in the sum
};

}  // namespace mba_vo
