#pragma once

#include "mba_vo/tracking/tracked_frame.h"
#include "sequence.h"

namespace mba_vo::study {

/// How one tracked frame differs from the truth.
struct Errors {
  bool tracking = false;           // reported as kTracking
  bool converged = false;          // mid pose within 1 px, motion within 1.5 px or 10 %, sign included
  double mid_px = 0.0;             // of reprojection, mean over the image
  double motion_px = 0.0;          // of the motion within the exposure, mean along the border of the image at 2 m
  bool sign_right = false;         // of that motion
  bool points_within_2px = false;  // 95 % of the map points that the frame sees
  double pose_nees = 0.0;          // normalised estimation error squared over its expectation
  double xi_nees = 0.0;
};

Errors compare(const Case& truth, const TrackedFrame& tracked);

}  // namespace mba_vo::study
