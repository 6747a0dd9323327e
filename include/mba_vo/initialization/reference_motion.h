#pragma once

#include "mba_vo/geometry/body_motion.h"
#include "mba_vo/initialization/initializer.h"
#include "mba_vo/tracking/reference.h"
#include "mba_vo/tracking/tracker.h"

namespace mba_vo {

/// The reference of a first map as the tracker takes it, moving so while its rows were read.
Reference initialReference(const InitialMap& initial, const BodyMotion& motion);

/// How it moved, by the poses next to it. All that is seen from it later depends on that where the shutter rolls: there
/// the images next to it are tracked, which tell it better than the initialiser does.
BodyMotion referenceMotion(const InitialMap& initial, const TrackerConfig& config);

}  // namespace mba_vo
