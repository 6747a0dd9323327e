#pragma once

#include <string>
#include <vector>

namespace mba_vo {

/// One input frame as listed in frames.csv of the odometry.
struct LoggedFrame {
  double time = 0.0;   // mid-exposure [s]
  std::string status;  // INITIALIZING, TRACKING, DEGRADED, LOST or REJECTED
};

/// Reads the columns `time` and `status` of a frames.csv. Throws std::runtime_error naming file and line if malformed.
std::vector<LoggedFrame> readFrameLog(const std::string& file);

/// Splits a line of comma-separated values; a field in double quotes may hold commas and doubled quotes.
std::vector<std::string> splitCsvLine(const std::string& line);

}  // namespace mba_vo
