#pragma once

#include "mba_vo/solver/schur_complement.h"
#include "mba_vo/window/window_linearizer.h"

namespace mba_vo {

inline constexpr int kCorrectionDim = CalibrationCorrection::kDim;

/// Where the states are: those of the keyframes, then their velocities by the rows, then the correction.
struct ImagingLayout {
  int keyframes;
  double half_readout;  // from the middle row to the last [s], 0: all rows at once, and there are no velocities

  bool rolling() const { return half_readout > 0.0; }
  static int pose(int keyframe) { return kKeyframeDim * keyframe; }
  int velocity(int keyframe) const { return kKeyframeDim * (keyframes + keyframe); }
  int correction() const { return kKeyframeDim * keyframes * (rolling() ? 2 : 1); }
  int size() const { return correction() + 2 * kKeyframeDim; }  // the correction's, filled up to keyframes'
};

/// Normal equations of all residuals of the evaluation, at the current state, and of what is known of the velocities
/// without the rows: those by the frames around.
LinearizedWindow assembleImaging(const WindowState& state, const WindowEvaluation& evaluation,
                                 const ImagingLayout& layout);

}  // namespace mba_vo
