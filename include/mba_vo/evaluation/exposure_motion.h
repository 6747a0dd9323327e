#pragma once

#include <optional>

#include "mba_vo/evaluation/pose_file.h"

namespace mba_vo {

/// How well the motion within one exposure was estimated, seen as the streaks it draws into the image.
///
/// The field of a motion is the displacement, start to end of the exposure, of points 2 m away over the image of a
/// 752x480 camera with f = 430 px. The sign counts: a motion estimated backwards has a direction error of 180 deg.
struct ExposureMotionError {
  double direction = 0.0;     // angle between the two fields, each taken as one long vector [deg]
  double length_ratio = 0.0;  // rms length of the estimated over that of the true displacements
  double blur_px = 0.0;       // mean length of the true displacements [px]
};

/// `scale`: metres of ground truth per unit of the estimate. nullopt if the true motion is too small to have a
/// direction (mean length below `min_blur` [px]).
std::optional<ExposureMotionError> compareExposureMotion(const ExposurePoses& groundtruth,
                                                         const ExposurePoses& estimate, double scale, double min_blur);

}  // namespace mba_vo
