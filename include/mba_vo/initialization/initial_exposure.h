#pragma once

#include <optional>

#include "mba_vo/initialization/initializer.h"
#include "mba_vo/tracking/exposure_probe.h"

namespace mba_vo {

/// For how long the frames of a first map were exposed, which nobody told: about alike, and as their blur agrees best
/// with the map's reference and with how the camera moved. nullopt where nothing is blurred.
std::optional<ExposureSample> initialExposure(const InitialMap& initial, const TrackerConfig& config);

}  // namespace mba_vo
