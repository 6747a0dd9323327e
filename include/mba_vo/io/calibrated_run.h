#pragma once

#include <functional>
#include <memory>

#include "mba_vo/io/offline_run.h"

namespace mba_vo {

/// How often, and why, a sequence was begun anew.
struct CalibratedRun {
  std::function<std::unique_ptr<SequenceReader>()> open;  // the sequence, from its beginning
  ProgressCallback progress;
  std::function<void(const CalibrationCorrection&)> onRestart;  // may be empty
};

/// Runs the odometry over a whole sequence. Where the images say that the calibration is wrong, it is begun anew with
/// the corrected one, so that the beginning gains as well; a right calibration costs nothing.
OfflineResult runCalibrated(const CalibratedRun& run, OfflineOptions options);

}  // namespace mba_vo
