#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mba_vo/io/recorded_motion.h"
#include "mba_vo/io/sequence.h"

namespace mba_vo {

/// Where motion and depths of a frame come from.
class GeometrySource {
 public:
  virtual ~GeometrySource() = default;
  virtual std::optional<FrameMotion> motion(std::int64_t mid_exposure_ns) const = 0;
  virtual std::vector<DepthSample> depths(const PinholeCamera& camera, const FrameMotion& motion,
                                          const CameraImage& image) const = 0;
};

/// exposure_trajectory.txt and points.txt of a run.
std::unique_ptr<GeometrySource> estimatedGeometry(const std::string& run_folder);

/// groundtruth.txt, groundtruth_exposure.txt and depth/ of a simulated sequence.
std::unique_ptr<GeometrySource> trueGeometry(const std::string& sequence_folder);

}  // namespace mba_vo
