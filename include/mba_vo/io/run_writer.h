#pragma once

#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "mba_vo/io/offline_run.h"

namespace mba_vo {

/// keyframes.csv: one row per keyframe with the time of each stage.
void writeKeyframes(const std::vector<KeyframeReport>& keyframes, std::ostream& out);
/// summary.yaml: `settings` (name, value) first, then counts, times and memory.
void writeSummary(const OfflineResult& result, const std::vector<std::pair<std::string, std::string>>& settings,
                  std::ostream& out);

/// Writes all files of a run into `folder`, which is made if need be. Throws std::runtime_error naming what fails.
void writeRun(const std::string& folder, const OfflineResult& result,
              const std::vector<std::pair<std::string, std::string>>& settings);

/// Largest memory the process has held so far [MB].
double peakMemoryMegabytes();

}  // namespace mba_vo
