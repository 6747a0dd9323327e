#pragma once

#include <string>
#include <vector>

#include "mba_vo/evaluation/csv_file.h"

namespace mba_vo {

/// One input frame as listed in frames.csv of the odometry.
struct LoggedFrame {
  double time = 0.0;   // mid-exposure [s]
  std::string status;  // INITIALIZING, TRACKING, DEGRADED, LOST, REPEATED or REJECTED
};

/// The columns `time` and `status` of a frames.csv. Throws std::runtime_error naming file and line if malformed.
std::vector<LoggedFrame> frameLog(const CsvTable& table);
std::vector<LoggedFrame> readFrameLog(const std::string& file);

}  // namespace mba_vo
