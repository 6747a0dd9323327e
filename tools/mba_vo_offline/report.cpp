#include "report.h"

#include <cmath>
#include <iostream>
#include <stdexcept>
#include <string>

#include "mba_vo/image/static_overlay.h"

void printCounts(const mba_vo::OfflineResult& result) {
  const mba_vo::FrameCounts counts = mba_vo::countFrames(result.log.frames());
  std::cout << counts.tracked << " of " << counts.frames << " frames tracked, " << counts.repeated << " repeat others, "
            << counts.dropped_after_initialization << " dropped after initialisation, " << counts.rejected
            << " rejected at the input, " << result.log.keyframes().size() << " keyframes, " << counts.maps
            << " map(s), "
            << (counts.metric_maps == 0 ? "scale arbitrary" : std::to_string(counts.metric_maps) + " in metres") << ", "
            << result.times.total << " s\n";
  if (!result.overlay.empty()) {
    std::cout << "static overlay: " << 1e2 * mba_vo::shareOf(result.overlay) << " % of the image masked\n";
  }
  if (counts.tracked == 0) {
    throw std::runtime_error("no frame could be tracked; frames.csv tells why");
  }
}

void printLearnt(const mba_vo::OfflineResult& result) {
  using mba_vo::CalibrationCorrection;
  const CalibrationCorrection& c = result.correction;
  if (!c.values.head<CalibrationCorrection::kGeometryDim>().isZero(0.0)) {
    std::cout << "the calibration is wrong: focal length " << 1e2 * c[CalibrationCorrection::kFocal] << " %, centre "
              << 1e2 * c[CalibrationCorrection::kCentreX] << ", " << 1e2 * c[CalibrationCorrection::kCentreY]
              << " % of the focal length, k1 " << c[CalibrationCorrection::kK1] << ", k2 "
              << c[CalibrationCorrection::kK2] << ", read-out " << 1e3 * c[CalibrationCorrection::kReadout] << " ms; ";
  }
  if (c.correctsVignette()) {
    std::cout << "the corners of the image get " << 1e2 * std::exp(c.vignette().sum()) << " % of the light; ";
  }
  const mba_vo::ExposureCorrection& exposure = result.exposure_correction;
  if (exposure.missing) std::cout << "images without an exposure had " << 1e3 * *exposure.missing << " ms; ";
  if (exposure.factor != 1.0) std::cout << "exposures are " << exposure.factor << " times as long as they say; ";
  std::cout << "beginning anew" << std::endl;
}
