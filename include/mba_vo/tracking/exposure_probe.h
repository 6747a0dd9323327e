#pragma once

#include <optional>

#include "mba_vo/tracking/reference.h"
#include "mba_vo/tracking/tracked_frame.h"
#include "mba_vo/tracking/tracker.h"

namespace mba_vo {

/// What the blur of one frame says about its exposure.
struct ExposureSample {
  double exposure = 0.0;   // with which the frame agrees best [s]
  double log_sigma = 0.0;  // standard deviation of its logarithm
};

/// Velocity that makes the blur left in a reference, if it was exposed as long as the frame.
Vector6 blurVelocity(const Reference& reference, const TrackedFrame& tracked);

/// Tries exposures, at most `longest` [s]: with which does the frame, seen while moving with `velocity`, agree best
/// with the reference? Those around the `expected` one are tried, or, where little is known of it, all of them: where
/// the blur is wrong altogether, one that is a bit less wrong may be no better. The velocity has to come from
/// elsewhere, as from the poses of the frames before and after it. A reference with blur of its own is taken as exposed
/// as long as the frame. nullopt if there is no best one, as where hardly anything is blurred.
std::optional<ExposureSample> probeExposure(const Reference& reference, const TrackedFrame& tracked,
                                            const Vector6& velocity, const ExposureSample& expected, double longest,
                                            const TrackerConfig& config);

}  // namespace mba_vo
