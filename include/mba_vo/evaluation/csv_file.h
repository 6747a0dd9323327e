#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace mba_vo {

/// Rows of comma-separated values under a line of column names, all of the same number of fields.
struct CsvTable {
  std::string file;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;

  /// Index of the column; std::runtime_error naming file and column if there is none.
  std::size_t column(const std::string& name) const;
  /// `file:line` of a row, for messages.
  std::string where(std::size_t row) const;
};

/// Throws std::runtime_error naming file and line if it cannot be read or a row is too short or too long.
CsvTable readCsv(const std::string& file);

/// Splits a line of comma-separated values; a field in double quotes may hold commas and doubled quotes.
std::vector<std::string> splitCsvLine(const std::string& line);

/// The number that is the whole of `text`; nullopt if it is none or not finite.
std::optional<double> finiteNumber(const std::string& text);

}  // namespace mba_vo
