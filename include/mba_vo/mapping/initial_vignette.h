#pragma once

#include "mba_vo/initialization/initializer.h"
#include "mba_vo/window/calibration_system.h"

namespace mba_vo {

/// What the points of a first map say about the vignette of its images, by how their brightness changes as they move
/// outwards. Of the geometry it says nothing. `present`: the correction to which something may lack.
CalibrationSystem linearizeInitialVignette(const InitialMap& initial, const CalibrationCorrection& present);

}  // namespace mba_vo
