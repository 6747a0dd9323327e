#include "mba_vo/io/calibrated_run.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

namespace mba_vo {
namespace {

constexpr std::size_t kImages = 600;  // that tell about the camera
constexpr int kMostRestarts = 5;

/// The run that made it necessary to begin anew: what it knew of the camera, and images with a pose.
struct Before {
  CalibrationCorrection known;
  ExposureCorrection exposure_correction;
  std::size_t poses;
};

std::size_t countPoses(const OfflineResult& result) {
  const std::vector<FrameRecord>& frames = result.log.frames();
  const auto end = frames.begin() + static_cast<std::ptrdiff_t>(std::min(kImages, frames.size()));
  return static_cast<std::size_t>(std::count_if(frames.begin(), end, [](const FrameRecord& f) { return f.hasPose(); }));
}

}  // namespace

OfflineResult runCalibrated(const CalibratedRun& run, OfflineOptions options) {
  bool learns = !options.live;  // a live run has one pass
  std::optional<Before> before;
  for (int restarts = 0;; ++restarts) {
    options.stop_if_learnt_within = learns && restarts < kMostRestarts ? kImages : 0;
    const auto reader = run.open();
    OfflineResult result = runOffline(*reader, options, run.progress);
    result.restarts = restarts;
    const std::size_t poses = countPoses(result);
    if (before && 2 * poses < before->poses) {
      options.known = before->known;
      options.exposure_correction = before->exposure_correction;
      learns = false;
      before.reset();
      if (run.onReturn) run.onReturn();
      continue;
    }
    if (!result.stopped_to_restart) return result;
    before = Before{options.known, options.exposure_correction, poses};
    options.known = result.correction;
    options.exposure_correction = result.exposure_correction;
    if (run.onRestart) run.onRestart(result);
  }
}

}  // namespace mba_vo
