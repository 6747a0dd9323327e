#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "mba_vo/deblur/deblurrer.h"
#include "mba_vo/mapping/local_map.h"

namespace mba_vo {

/// Motion of one exposure, as a run or a simulation wrote it.
struct RecordedExposure {
  std::int64_t mid_exposure_ns = 0;  // [ns]
  MapId map_id = 0;
  ExposureTrajectory trajectory;  // camera to map
};

/// What a deblurrer wants to know about the motion of a frame.
struct FrameMotion {
  MapId map_id = 0;
  ExposureTrajectory trajectory;  // camera to map, with acceleration
  Vector6 measured_velocity;      // by the frame's own blur alone [m/s, rad/s]
};

/// The motion during the exposures of a finished run: velocities mostly from the poses before and after, as the mapper
/// has them (FiniteDifferenceVelocity), accelerations from the velocities.
class RecordedMotion {
 public:
  /// In order of time.
  explicit RecordedMotion(std::vector<RecordedExposure> exposures) : exposures_(std::move(exposures)) {}

  /// nullopt if no pose is known within a microsecond of that time.
  std::optional<FrameMotion> at(std::int64_t mid_exposure_ns) const;

 private:
  bool areNeighbours(std::size_t i, std::size_t j) const;

  std::vector<RecordedExposure> exposures_;
};

/// Depths in a frame, of the map's points from keyframes that are near in time and so see the same surfaces.
std::vector<DepthSample> depthsInFrame(const std::vector<MapPoint>& points, const PinholeCamera& camera,
                                       const FrameMotion& motion, std::int64_t mid_exposure_ns);

}  // namespace mba_vo
