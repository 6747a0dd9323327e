#include "mba_vo/evaluation/frame_log.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>

namespace mba_vo {
namespace {

std::size_t columnOf(const std::vector<std::string>& header, const std::string& name, const std::string& file) {
  const auto found = std::find(header.begin(), header.end(), name);
  if (found == header.end()) {
    throw std::runtime_error(file + ":1: no column named '" + name + "'");
  }
  return static_cast<std::size_t>(found - header.begin());
}

double parseTime(const std::string& text, const std::string& where) {
  std::size_t used = 0;
  double time = 0.0;
  try {
    time = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (used != text.size() || used == 0 || !std::isfinite(time)) {
    throw std::runtime_error(where + ": time '" + text + "' is not a finite number");
  }
  return time;
}

}  // namespace

std::vector<std::string> splitCsvLine(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += '"';
      ++i;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else if (c != '\r') {
      fields.back() += c;
    }
  }
  return fields;
}

std::vector<LoggedFrame> readFrameLog(const std::string& file) {
  std::ifstream stream(file);
  std::string line;
  if (!stream || !std::getline(stream, line)) {
    throw std::runtime_error(file + ": cannot be read or is empty");
  }
  const std::vector<std::string> header = splitCsvLine(line);
  const std::size_t time_column = columnOf(header, "time", file);
  const std::size_t status_column = columnOf(header, "status", file);
  std::vector<LoggedFrame> frames;
  for (int line_number = 2; std::getline(stream, line); ++line_number) {
    const std::string where = file + ":" + std::to_string(line_number);
    const std::vector<std::string> fields = splitCsvLine(line);
    if (fields.size() != header.size()) {
      throw std::runtime_error(where + ": " + std::to_string(fields.size()) + " fields, the header has " +
                               std::to_string(header.size()));
    }
    frames.push_back({parseTime(fields[time_column], where), fields[status_column]});
  }
  return frames;
}

}  // namespace mba_vo
