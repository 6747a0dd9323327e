#include "mba_vo/io/calibration_passes.h"

#include <cmath>
#include <stdexcept>

namespace mba_vo {
namespace {

/// Neither the factor on exposures nor, by more than its standard deviation, any other number.
bool changedNothing(const CalibrationStudy& study, const OfflineOptions& before) {
  const CalibrationCorrection::Vector change = before.known.lacks(study.last.correction).values;
  return study.last.exposure_correction.factor == before.exposure_correction.factor &&
         (change.cwiseAbs().array() <= study.estimate.sigma().array()).all();
}

/// Whether rows are exposed one after another, as far as the estimate is sure: steps of the other numbers take the
/// read-out time along by microseconds.
bool isRolling(const CalibrationEstimate& estimate, double told_readout) {
  constexpr auto kReadout = CalibrationCorrection::kReadout;
  return std::abs(told_readout + estimate.correction[kReadout]) > 3.0 * estimate.sigma()(kReadout);
}

}  // namespace

CalibrationCorrection CalibrationStudy::correction() const {
  CalibrationCorrection correction = estimate.correction;
  if (!last.correction.correctsLens()) correction.values.head<CalibrationCorrection::kReadout>().setZero();
  if (last.correction[CalibrationCorrection::kReadout] == 0.0) correction.values(CalibrationCorrection::kReadout) = 0.0;
  if (!last.correction.correctsVignette()) correction.values.tail<CalibrationCorrection::kVignetteDim>().setZero();
  return correction;
}

CalibrationStudy studyCalibration(const CalibratedRun& run, OfflineOptions options, int most_passes) {
  if (!options.config.mapper.refine_calibration) {
    throw std::runtime_error("option 'mapper.refine_calibration' is false: nothing would be learnt");
  }
  CameraKind camera{options.config.mapper.vignette_told, false};
  CalibrationStudy study;
  while (!study.settled && study.passes < most_passes) {
    const auto reader = run.open();
    study.last = runOffline(*reader, options, run.progress);
    ++study.passes;
    const std::vector<KeyframeReport>& keyframes = study.last.log.keyframes();
    camera.rolling = false;
    const double readout = reader->calibration().height * options.config.image.row_time;
    camera.rolling = isRolling(estimateCalibration(keyframes, keyframes.size(), camera), readout);
    study.estimate = estimateCalibration(keyframes, keyframes.size(), camera);
    if (study.estimate.windows == 0) {
      throw std::runtime_error("no map held long enough to tell anything about the camera");
    }
    study.settled = changedNothing(study, options);
    options.known = study.last.correction;
    // Those that did not come may vary: they are followed from image to image in every pass.
    options.exposure_correction.factor = study.last.exposure_correction.factor;
    if (run.onRestart) run.onRestart(study.last);
  }
  const std::vector<KeyframeReport>& keyframes = study.last.log.keyframes();
  for (std::size_t i = 1; i <= keyframes.size(); ++i) {
    study.growth.push_back(estimateCalibration(keyframes, i, camera));
  }
  return study;
}

}  // namespace mba_vo
