#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mba_vo/evaluation/alignment.h"
#include "mba_vo/evaluation/frame_log.h"
#include "mba_vo/evaluation/pose_errors.h"
#include "mba_vo/evaluation/pose_file.h"
#include "mba_vo/evaluation/statistics.h"

namespace mba_vo {

struct EvaluationOptions {
  AlignmentMode alignment = AlignmentMode::kSim3;
  double max_time_difference = 0.01;  // between an estimate and its ground truth [s]
  double relative_interval = 1.0;     // of the relative pose error [s]
  double min_blur = 2.0;              // frames with less are left out of the error within the exposure [px]
};

/// Frames that should have a pose and those that have none.
struct FrameDrops {
  std::size_t frames = 0;
  std::size_t dropped = 0;
  std::size_t frames_after_initialization = 0;  // from the first frame with a pose in any map on
  std::size_t dropped_after_initialization = 0;
};

/// Error of start and end poses, aligned, and of the motion between them, see ExposureMotionError.
struct ExposureEvaluation {
  Statistics ends;           // distance between positions, start and end of each [m]
  Statistics ends_rotation;  // [deg]
  Statistics direction;      // [deg]
  Statistics length_ratio;   // estimated / true
  Statistics length_error;   // |length ratio - 1|
  std::size_t reversed = 0;  // frames with a direction error above 90 deg
};

struct EvaluationReport {
  AlignmentMode mode = AlignmentMode::kSim3;
  Similarity alignment;
  double relative_interval = 1.0;       // [s]
  std::vector<PosePair> pairs;          // aligned
  std::size_t unmatched_estimates = 0;  // of the evaluated map, without ground truth
  std::string clock_hint;               // if the clocks seem to differ
  int map = 0;                          // that is evaluated
  std::size_t maps = 1;
  std::size_t poses_in_other_maps = 0;  // not evaluated, counted as dropped
  Statistics absolute;                  // [m]
  Statistics rotation;                  // [deg]
  Statistics relative_translation;      // [m]
  Statistics relative_rotation;         // [deg]
  FrameDrops drops;
  std::map<std::string, std::size_t> frames_by_status;  // from frames.csv, else empty
  std::optional<ExposureEvaluation> exposure;           // if both files tell start and end poses
};

/// Compares an estimate with ground truth (both sorted by time, see readPoseFile). Only the map with the most poses is
/// evaluated: maps share no coordinates. Frames are the ground-truth stamps, or those of `frame_log` if not empty.
/// Throws std::runtime_error if fewer than three poses match in time.
EvaluationReport evaluateTrajectory(const std::vector<PoseRecord>& groundtruth, const std::vector<PoseRecord>& estimate,
                                    const std::vector<LoggedFrame>& frame_log, const EvaluationOptions& options);

}  // namespace mba_vo
