#pragma once

#include <optional>

#include "mba_vo/window/calibration_system.h"

namespace mba_vo {

/// Corrects the calibration where window after window agrees that it is wrong. A good calibration stays as it is: what
/// the windows then say is small beside its uncertainty. One that they disproved follows what they say. The
/// vignette comes first and needs one window alone; so may the time of read-out.
class CalibrationEstimator {
 public:
  enum class Vignette { kUnknown, kTold };  // kTold: nothing of it is left to be found

  explicit CalibrationEstimator(const CalibrationCorrection& start = {}, Vignette vignette = Vignette::kUnknown)
      : vignette_(vignette), correction_(start) {}

  /// The correction that new images should be made with.
  const CalibrationCorrection& correction() const { return correction_; }

  /// The last correction that one window after the other has left as it is, but for chance, for a while; nullopt if
  /// there was none.
  const std::optional<CalibrationCorrection>& settled() const { return settled_; }
  /// Whether they have left it exactly as it is.
  bool isSettled() const;

  /// Adds what a window says about errors left by the present correction. True if the correction changed.
  bool add(const CalibrationSystem& system);

 private:
  enum class Lens { kBelieved, kDisproved };  // kDisproved: a step of it was taken

  CalibrationSystem withPrior() const;
  bool correctVignette();
  bool correctReadout();
  bool correctLens();

  Vignette vignette_;
  Lens lens_ = Lens::kBelieved;
  CalibrationCorrection correction_;
  std::optional<CalibrationCorrection> settled_;
  CalibrationSystem sum_;  // of the windows, the more the later they are
  int windows_ = 0;        // since the correction changed
  int steady_ = 0;         // since it changed by more than chance
};

}  // namespace mba_vo
