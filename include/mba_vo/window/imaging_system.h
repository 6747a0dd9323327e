#pragma once

#include <vector>

#include "mba_vo/window/calibration_system.h"
#include "mba_vo/window/window_linearizer.h"

namespace mba_vo {

/// What the bundle adjustment takes as given, how the images came about, as the residuals see it, all poses, depths and
/// brightnesses eliminated; without the window's prior.
struct ImagingSystem {
  CalibrationSystem calibration;  // whatever the motions between the rows are
  /// Gauss-Newton steps of the velocities of the keyframes, by age, while their rows are read [m/s, rad/s]. That by the
  /// frames around is their prior. Empty with a global shutter.
  std::vector<Vector6> velocity_steps;
};

/// From every `stride`-th point.
ImagingSystem linearizeImaging(WindowState& state, const WindowLinearizer& linearizer, int stride);

/// Moves the velocities of keyframes whose rows were read one after the other to where the residuals want them. Returns
/// what else they say: errors left in the calibration.
CalibrationSystem refineRowMotions(WindowState& state, const WindowLinearizer& linearizer);

/// By how much gradients at the keyframes' states, with the depths of `points` (at least one) eliminated, change with
/// the correction of the calibration: as every `stride`-th of them says.
CalibrationCoupling calibrationCoupling(WindowState& state, const WindowLinearizer& linearizer,
                                        const std::vector<int>& points, std::size_t stride);

}  // namespace mba_vo
