#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "mba_vo/evaluation/pose_file.h"
#include "mba_vo/image/frame.h"
#include "recorded_run.h"

namespace mba_vo::study {

/// True poses and, where the folder has depth images, true surfaces.
class Truth {
 public:
  explicit Truth(const std::string& folder);

  std::optional<SE3> T_world_camera(std::int64_t ns) const;
  std::optional<SE3> T_reference_frame(const Reported& reported) const;
  /// True over estimated length, of each map as a whole.
  std::map<MapId, double> scales(const RecordedRun& run) const;
  /// Depths at mid-exposure [m], 0 where there is none; empty if the folder has none.
  cv::Mat1f depth(std::int64_t ns) const;

 private:
  std::string folder_;
  std::vector<PoseRecord> poses_;
  std::map<std::int64_t, std::uint64_t> ids_;  // of images, by time [ns]
};

}  // namespace mba_vo::study
