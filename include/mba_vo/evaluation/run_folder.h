#pragma once

#include <string>
#include <vector>

#include "mba_vo/evaluation/frame_log.h"
#include "mba_vo/evaluation/online_log.h"
#include "mba_vo/evaluation/pose_file.h"

namespace mba_vo {

/// Whether to read the motion within the exposure: it is worth comparing only if the ground truth has it too.
enum class PoseForm { kPoses, kExposures };

/// What a run wrote into its output folder. A run without poses has empty lists.
struct RunFolder {
  std::vector<PoseRecord> online_trajectory;  // camera to map, as first published
  std::vector<PoseRecord> online_odometry;    // camera to odom, as first published
  std::vector<PoseRecord> smoothed;           // camera to map, as saved at the end; empty if never saved
  std::vector<OnlineFrame> online_frames;     // one per input image
  std::vector<LoggedFrame> frames;            // the same images with their final status
  int restarts = 0;                           // how often the run was begun anew with what it had learnt
  bool metric = false;                        // lengths of the map are metres
};

/// Reads online_trajectory.txt, online_odometry.txt and frames.csv, and where there are any, start and end poses, the
/// smoothed trajectory and summary.yaml. Throws std::runtime_error naming file and line for what is missing or
/// malformed.
RunFolder readRunFolder(const std::string& folder, PoseForm form);

}  // namespace mba_vo
