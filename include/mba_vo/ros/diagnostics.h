#pragma once

#include <string>

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <mba_vo/MapperStatus.h>
#include <mba_vo/Status.h>

#include "mba_vo/image/camera_calibration.h"

namespace mba_vo {

/// What the tracker knows now, and what it said the last time.
struct TrackerHealth {
  Status before;
  Status now;
  double seconds = 0.0;       // between the two [s]
  double latency = 0.0;       // newest image: from its arrival to its result [s]; NaN = none yet
  std::string missing_input;  // empty: nothing is missing
  std::string calibration;    // in use; empty = none
};

/// The same of the mapper.
struct MapperHealth {
  MapperStatus before;
  MapperStatus now;
  double seconds = 0.0;       // between the two [s]
  double busy_seconds = 0.0;  // of these, in which the mapper worked
};

/// A calibration in one line.
std::string describe(const CameraCalibration& calibration);

/// Images: ERROR if none come or none are of use; WARN if some are not, some never arrived, or their exposure is
/// contradicted by the blur.
void diagnoseInput(const TrackerHealth& health, diagnostic_updater::DiagnosticStatusWrapper& diagnostic);
/// Poses: ERROR if lost or failed; WARN if degraded, without a map, late, or if images were shed.
void diagnoseTracking(const TrackerHealth& health, diagnostic_updater::DiagnosticStatusWrapper& diagnostic);
/// The map: ERROR if frames were of no use to the mapper; WARN if it does not keep up.
void diagnoseMapping(const MapperHealth& health, diagnostic_updater::DiagnosticStatusWrapper& diagnostic);

}  // namespace mba_vo
