#pragma once

#include "mba_vo/tracking/reference.h"

namespace mba_vo {

/// Standard deviation of where a frame sees the points of its reference, as the covariance of its pose (right increment
/// of `T_reference_frame`) lets expect [px]: 95 % of the points in view have less. 0 where none is in view.
double expectedPixelError(const Reference& reference, const SE3& T_reference_frame, const Matrix6& pose_covariance);

}  // namespace mba_vo
