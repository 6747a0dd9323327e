#pragma once

#include "mba_vo/relocalization/keyframe_archive.h"

namespace mba_vo {

/// By what a keyframe's unit of length is another's.
struct ScaleEstimate {
  double log_scale = 0.0;
  double sigma = 0.0;  // standard deviation of it
  int points = 0;      // that tell
};

/// Depths of `b` against those of `a` at the same places: lengths of b times the scale are lengths of a. `T_a_b`: with
/// a translation in a's unit. As b's points are seen in a, so are a's in b; both tell.
ScaleEstimate compareDepths(const ArchivedKeyframe& a, const ArchivedKeyframe& b, const SE3& T_a_b);

}  // namespace mba_vo
