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

/// Tries exposures around `exposure` [s], at most `longest`: with which does the frame, seen while moving with
/// `velocity`, agree best with the reference? The velocity has to come from elsewhere, as from the poses of the frames
/// before and after it. A reference with blur of its own is taken as exposed as long as the frame. nullopt if there is
/// no best one, as where hardly anything is blurred.
std::optional<ExposureSample> probeExposure(const Reference& reference, const TrackedFrame& tracked,
                                            const Vector6& velocity, double exposure, double longest,
                                            const TrackerConfig& config);

}  // namespace mba_vo
