#pragma once

#include <functional>
#include <memory>

#include "mba_vo/io/offline_run.h"

namespace mba_vo {

/// How often, and why, a sequence was begun anew.
struct CalibratedRun {
  std::function<std::unique_ptr<SequenceReader>()> open;  // the sequence, from its beginning
  ProgressCallback progress;
  std::function<void(const OfflineResult&)> onRestart;  // with what made it necessary; may be empty
  std::function<void()> onReturn;                       // to what was known before; may be empty
};

/// Runs the odometry over a whole sequence. Where the images say that the calibration is wrong, or what exposure those
/// have that came without, it is begun anew with that, so that the beginning gains as well; where nothing is to be
/// learnt it costs nothing. What was learnt is wrong where fewer than half as many images have a pose with it: the
/// sequence is then run through with what was known before.
OfflineResult runCalibrated(const CalibratedRun& run, OfflineOptions options);

}  // namespace mba_vo
