#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "mba_vo/geometry/exposure_trajectory.h"

namespace mba_vo {

/// One simulated frame with its exact ground truth.
struct SimulatedFrame {
  std::uint64_t id = 0;
  std::int64_t mid_exposure_ns = 0;
  double exposure = 0.0;         // [s]
  bool exposure_hidden = false;  // the camera does not tell it
  cv::Mat1b blurred;
  std::vector<unsigned char> jpeg;              // of which `blurred` was decoded; empty unless asked for
  cv::Mat1b sharp;                              // empty unless asked for
  cv::Mat1f depth;                              // z at mid-exposure [m]; empty unless asked for
  SE3 T_world_mid, T_world_start, T_world_end;  // camera (optical frame) to world
  double blur_px = 0.0;                         // mean image motion within the exposure at 2 m depth [px]

  /// What the camera tells of its exposure [s].
  std::optional<double> toldExposure() const {
    return exposure_hidden ? std::nullopt : std::optional<double>(exposure);
  }
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
