#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mba_vo/evaluation/pose_file.h"

namespace mba_vo {

/// A short simulated sequence as a bag with its ground truth, made on first use and kept for later runs.
struct DemoSequence {
  std::string bag;
  std::vector<std::int64_t> stamps;  // of all images [ns]
  std::vector<PoseRecord> groundtruth;
  double exposure = 0.0;  // [s]
};

/// `folder` keeps the bag and the rendered images.
DemoSequence makeDemoSequence(const std::string& folder);

}  // namespace mba_vo
