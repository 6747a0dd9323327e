#pragma once

#include <functional>
#include <vector>

#include "mba_vo/io/calibrated_run.h"
#include "mba_vo/io/calibration_estimate.h"

namespace mba_vo {

/// What a recording tells about its camera.
struct CalibrationStudy {
  CalibrationEstimate estimate;             // by all windows of the last pass
  std::vector<CalibrationEstimate> growth;  // after each of its keyframes
  OfflineResult last;                       // that pass
  int passes = 0;
  bool settled = false;  // the last pass changed no number by more than its standard deviation

  /// What a camera should be used with: the estimate, but of lens, row time and vignette only what steps were taken
  /// for. A shutter that hardly rolls does not roll.
  CalibrationCorrection correction() const;
};

/// Runs over the sequence again and again, each time with what was learnt before, until a pass changes no number
/// by more than its standard deviation, or `most_passes` are over. Throws std::runtime_error if no window told
/// anything.
CalibrationStudy studyCalibration(const CalibratedRun& run, OfflineOptions options, int most_passes);

}  // namespace mba_vo
