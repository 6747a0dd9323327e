#pragma once

#include <vector>

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

/// Residuals over the gradients of the frame where it sees these points of the reference: by how much the pose is wrong
/// at most, if nothing else is [px]. 0 where there are no gradients.
double pixelError(const Reference& reference, const std::vector<int>& points, const ImageLevel& frame,
                  const SE3& T_reference_frame, double residual_rms);

}  // namespace mba_vo
