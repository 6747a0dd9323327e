#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "mba_vo/tracking/reference.h"

namespace mba_vo {

/// A point of the map for display.
struct MapPoint {
  Eigen::Vector3d position_map;  // [m], up to the monocular scale
  float intensity = 0.0F;        // [grey levels]
  KeyframeId keyframe_id = 0;
  std::int64_t keyframe_ns = 0;  // mid-exposure time of that keyframe [ns]
  MapId map_id = 0;
};

}  // namespace mba_vo
