#include "mba_vo/evaluation/report_format.h"

#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>

namespace mba_vo {
namespace {

constexpr int kNameWidth = 38;
constexpr int kValueWidth = 11;
constexpr int kCountWidth = 8;

}  // namespace

std::string fixedText(double value, int decimals) {
  if (!std::isfinite(value)) {
    return "-";
  }
  std::ostringstream text;
  text << std::fixed << std::setprecision(decimals) << value;
  return text.str();
}

double percent(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

const char* toString(AlignmentMode mode) { return mode == AlignmentMode::kSim3 ? "sim3" : "se3"; }

void writeStatisticsHeader(std::ostream& out) {
  out << std::left << std::setw(kNameWidth) << "" << std::right;
  for (const char* column : {"RMSE", "mean", "median", "90 %", "max"}) {
    out << std::setw(kValueWidth) << column;
  }
  out << std::setw(kCountWidth) << "n"
      << "\n";
}

void writeStatisticsRow(std::ostream& out, const std::string& name, const Statistics& s, int decimals) {
  out << std::left << std::setw(kNameWidth) << name << std::right;
  for (const double value : {s.rmse, s.mean, s.median, s.percentile_90, s.max}) {
    out << std::setw(kValueWidth) << fixedText(value, decimals);
  }
  out << std::setw(kCountWidth) << s.count << "\n";
}

std::string yamlNumber(double value) {
  std::ostringstream text;
  text << std::setprecision(std::numeric_limits<double>::max_digits10) << value;
  return std::isfinite(value) ? text.str() : ".nan";
}

void writeYamlStatistics(std::ostream& out, const std::string& indent, const std::string& name, const Statistics& s) {
  out << indent << name << ": {rmse: " << yamlNumber(s.rmse) << ", mean: " << yamlNumber(s.mean)
      << ", median: " << yamlNumber(s.median) << ", percentile_90: " << yamlNumber(s.percentile_90)
      << ", max: " << yamlNumber(s.max) << ", count: " << s.count << "}\n";
}

}  // namespace mba_vo
