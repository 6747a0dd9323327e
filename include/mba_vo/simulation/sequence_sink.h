#pragma once

#include <cstdint>
#include <optional>

#include <opencv2/core.hpp>

#include "mba_vo/geometry/exposure_trajectory.h"

namespace mba_vo {

/// One simulated frame with its exact ground truth.
struct SimulatedFrame {
  std::uint64_t id = 0;
  std::int64_t mid_exposure_ns = 0;
  double exposure = 0.0;  // [s]
  cv::Mat1b blurred;
  cv::Mat1b sharp;                              // empty unless asked for
  cv::Mat1f depth;                              // z at mid-exposure [m]; empty unless asked for
  SE3 T_world_mid, T_world_start, T_world_end;  // camera (optical frame) to world
  double blur_px = 0.0;                         // mean image motion within the exposure at 2 m depth [px]
};

/// Receives simulated frames in order: writes a sequence folder, a bag, or keeps them for a test.
class SequenceSink {
 public:
  virtual ~SequenceSink() = default;
  virtual void write(const SimulatedFrame& frame) = 0;
  /// Called once after the last frame.
  virtual void finish() = 0;
};

}  // namespace mba_vo
