#pragma once

#include "mba_vo/geometry/exposure_trajectory.h"
#include "mba_vo/tracking/reference.h"

namespace mba_vo {

/// How a frame sees the points of its reference.
struct FrameMeasures {
  double blur_length_px = 0.0;    // median image path within the exposure
  double flow_px = 0.0;           // rms displacement of the points between reference and frame
  double parallax_px = 0.0;       // rms of the part that translation causes
  double visible_fraction = 0.0;  // of the points inside the frame
};

FrameMeasures measureFrame(const Reference& reference, const ExposureTrajectory& trajectory);

/// Of the points of a reference; 1 if it has none [m].
double medianDepth(const Reference& reference);

}  // namespace mba_vo
