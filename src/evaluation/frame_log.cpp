#include "mba_vo/evaluation/frame_log.h"

#include <stdexcept>

namespace mba_vo {

std::vector<LoggedFrame> frameLog(const CsvTable& table) {
  const std::size_t time_column = table.column("time");
  const std::size_t status_column = table.column("status");
  std::vector<LoggedFrame> frames;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const std::string& text = table.rows[row][time_column];
    const std::optional<double> time = finiteNumber(text);
    if (!time) {
      throw std::runtime_error(table.where(row) + ": time '" + text + "' is not a finite number");
    }
    frames.push_back({*time, table.rows[row][status_column]});
  }
  return frames;
}

std::vector<LoggedFrame> readFrameLog(const std::string& file) { return frameLog(readCsv(file)); }

}  // namespace mba_vo
