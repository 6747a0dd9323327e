#pragma once

#include <cstdint>
#include <optional>

#include "mba_vo/tracking/reference.h"
#include "mba_vo/window/calibration_system.h"
#include "mba_vo/window/depth_agreement.h"

namespace mba_vo {

/// What a window tells about the calibration.
struct CalibrationEvidence {
  CalibrationCorrection correction;  // that its images should have been made with
  CalibrationSystem system;          // of what this lacks
};

/// What inserting one keyframe cost [ms], by stage.
struct KeyframeReport {
  KeyframeId keyframe_id = 0;
  std::uint64_t frame_sequence = 0;
  std::int64_t mid_exposure_ns = 0;
  double blur_length_px = 0.0;
  int points = 0;                // active points in the window afterwards
  int wanted_points = 0;         // that it is to hold with this keyframe, see PointBudget
  int residuals = 0;             // in the last optimisation
  int activation_residuals = 0;  // compared to find the depths of new points
  double rms = 0.0;              // of the window's residuals [grey levels]
  double error_px = 0.0;         // shift of the image that would make such residuals [px]
  DepthAgreement depths;         // of measured depths and images
  std::optional<CalibrationEvidence> calibration;
  double depth_search_ms = 0.0;  // spent on frames since the last keyframe
  double activation_ms = 0.0;
  double optimisation_ms = 0.0;
  double calibration_ms = 0.0;
  double marginalisation_ms = 0.0;
  double selection_ms = 0.0;
  double total_ms = 0.0;
};

}  // namespace mba_vo
