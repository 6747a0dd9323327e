#pragma once

#include "mba_vo/tracking/tracked_frame.h"

namespace mba_vo {

/// Of an alignment to the map. The tracker's covariance knows the noise. What else is wrong, depths above all, does
/// most harm where a few patches of new points have to tell for all the image, as on a fast turn: the error grows with
/// the square of what noise makes.
Matrix12 alignmentCovariance(const TrackedFrame& tracked);

}  // namespace mba_vo
