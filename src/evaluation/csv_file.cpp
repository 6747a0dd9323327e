#include "mba_vo/evaluation/csv_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>

namespace mba_vo {

std::size_t CsvTable::column(const std::string& name) const {
  const auto found = std::find(header.begin(), header.end(), name);
  if (found == header.end()) {
    throw std::runtime_error(file + ":1: no column named '" + name + "'");
  }
  return static_cast<std::size_t>(found - header.begin());
}

std::string CsvTable::where(std::size_t row) const {
  constexpr std::size_t kFirstLineOfRows = 2;
  return file + ":" + std::to_string(row + kFirstLineOfRows);
}

CsvTable readCsv(const std::string& file) {
  std::ifstream stream(file);
  std::string line;
  if (!stream || !std::getline(stream, line)) {
    throw std::runtime_error(file + ": cannot be read or is empty");
  }
  CsvTable table{file, splitCsvLine(line), {}};
  while (std::getline(stream, line)) {
    table.rows.push_back(splitCsvLine(line));
    if (table.rows.back().size() != table.header.size()) {
      throw std::runtime_error(table.where(table.rows.size() - 1) + ": " + std::to_string(table.rows.back().size()) +
                               " fields, the header has " + std::to_string(table.header.size()));
    }
  }
  return table;
}

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

std::optional<double> finiteNumber(const std::string& text) {
  std::size_t used = 0;
  double value = 0.0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    return std::nullopt;
  }
  return used == text.size() && std::isfinite(value) ? std::optional<double>(value) : std::nullopt;
}

}  // namespace mba_vo
