#pragma once

#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "mba_vo/io/calibration_passes.h"

namespace mba_vo {

/// A number of a calibration: what was told, and what was found.
struct CalibratedNumber {
  std::string name;
  std::string unit;  // may be empty
  double told = 0.0;
  double found = 0.0;
  double sigma = 0.0;  // standard deviation of what was found

  double significance() const { return sigma > 0.0 ? (found - told) / sigma : 0.0; }
};

/// What a study was told about the camera.
struct ToldCamera {
  CameraCalibration calibration;
  FrameBuilderConfig image;
};

/// What the estimate says of focal length, centre, further radial distortion, row time and light in the corners; the
/// last only where no vignette was told.
std::vector<CalibratedNumber> calibratedNumbers(const ToldCamera& told, const CalibrationEstimate& estimate);

/// Light at `q`, the squared radius, 1 in the corners, and its standard deviation, of that in the middle.
std::pair<double, double> lightAt(double q, const CalibrationEstimate& estimate);

/// The factor on exposures that came, or the exposure where none came [s]; nullopt if nothing is known.
std::optional<CalibratedNumber> calibratedExposure(const OfflineResult& result);

/// For people.
void printCalibration(const ToldCamera& told, const CalibrationStudy& study, std::ostream& out);

/// Into `folder`, which is made if need be: camera.yaml (camera_info), sensor.yaml (`image.learnt_file` that belongs to
/// it), calibration.yaml (the figures), and mask.png (`image.mask_file`) where something covers the scene. Throws
/// std::runtime_error naming what cannot be written.
void writeCalibration(const std::string& folder, const ToldCamera& told, const CalibrationStudy& study);

}  // namespace mba_vo
