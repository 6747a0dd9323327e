#include "mba_vo/io/calibrated_run.h"

namespace mba_vo {
namespace {

constexpr std::size_t kImages = 600;  // that tell about the camera
constexpr int kMostRestarts = 5;

}  // namespace

OfflineResult runCalibrated(const CalibratedRun& run, OfflineOptions options) {
  for (int restarts = 0;; ++restarts) {
    // A live run has one pass.
    options.stop_if_learnt_within = restarts < kMostRestarts && !options.live ? kImages : 0;
    const auto reader = run.open();
    OfflineResult result = runOffline(*reader, options, run.progress);
    result.restarts = restarts;
    if (!result.stopped_to_restart) return result;
    options.known = result.correction;
    options.exposure_correction = result.exposure_correction;
    if (run.onRestart) run.onRestart(result);
  }
}

}  // namespace mba_vo
