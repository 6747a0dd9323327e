#include "mba_vo/evaluation/report_writer.h"

#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>
#include <string>

namespace mba_vo {
namespace {

std::string fixed(double value, int decimals) {
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

void writeRow(std::ostream& out, const std::string& name, const Statistics& s, int decimals) {
  constexpr int kNameWidth = 38;
  constexpr int kValueWidth = 11;
  out << std::left << std::setw(kNameWidth) << name << std::right;
  for (const double value : {s.rmse, s.mean, s.median, s.percentile_90, s.max}) {
    out << std::setw(kValueWidth) << fixed(value, decimals);
  }
  out << std::setw(8) << s.count << "\n";
}

void writeDrops(std::ostream& out, const std::string& name, std::size_t dropped, std::size_t frames) {
  out << "  " << std::left << std::setw(22) << name << dropped << " of " << frames << " ("
      << fixed(percent(dropped, frames), 1) << " %)\n";
}

void writeYamlStatistics(std::ostream& out, const std::string& indent, const std::string& name, const Statistics& s) {
  const auto number = [](double value) {
    std::ostringstream text;
    text << std::setprecision(std::numeric_limits<double>::max_digits10) << value;
    return std::isfinite(value) ? text.str() : std::string(".nan");
  };
  out << indent << name << ": {rmse: " << number(s.rmse) << ", mean: " << number(s.mean)
      << ", median: " << number(s.median) << ", percentile_90: " << number(s.percentile_90)
      << ", max: " << number(s.max) << ", count: " << s.count << "}\n";
}

const char* toString(AlignmentMode mode) { return mode == AlignmentMode::kSim3 ? "sim3" : "se3"; }

}  // namespace

void writeTable(const EvaluationReport& report, std::ostream& out) {
  constexpr int kMillimetreTenths = 5;
  constexpr int kDegreeDecimals = 3;
  out << "alignment " << toString(report.mode) << ", scale " << std::setprecision(6) << report.alignment.scale
      << " (true / estimated length), " << report.pairs.size() << " poses compared\n\n";
  out << std::left << std::setw(38) << "" << std::right;
  for (const char* column : {"RMSE", "mean", "median", "90 %", "max"}) {
    out << std::setw(11) << column;
  }
  out << std::setw(8) << "n"
      << "\n";
  const std::string interval = " over " + fixed(report.relative_interval, 2) + " s";
  writeRow(out, "ATE [m]", report.absolute, kMillimetreTenths);
  writeRow(out, "rotation [deg]", report.rotation, kDegreeDecimals);
  writeRow(out, "RPE" + interval + ", translation [m]", report.relative_translation, kMillimetreTenths);
  writeRow(out, "RPE" + interval + ", rotation [deg]", report.relative_rotation, kDegreeDecimals);
  if (report.exposure) {
    writeRow(out, "within the exposure, direction [deg]", report.exposure->direction, kDegreeDecimals);
    writeRow(out, "within the exposure, length ratio", report.exposure->length_ratio, kDegreeDecimals);
    writeRow(out, "within the exposure, |ratio - 1|", report.exposure->length_error, kDegreeDecimals);
    out << "  estimated backwards   " << report.exposure->reversed << " of " << report.exposure->direction.count
        << " frames with enough blur\n";
  }
  out << "\nframes dropped\n";
  writeDrops(out, "in all", report.drops.dropped, report.drops.frames);
  writeDrops(out, "after initialisation", report.drops.dropped_after_initialization,
             report.drops.frames_after_initialization);
  if (report.maps > 1) {
    out << "  " << report.maps << " maps: the largest is evaluated, " << report.poses_in_other_maps
        << " poses of the others count as dropped\n";
  }
  if (report.unmatched_estimates > 0) {
    out << "  " << report.unmatched_estimates << " estimated poses have no ground truth and are not evaluated\n";
  }
  for (const auto& [status, count] : report.frames_by_status) {
    out << "  " << std::left << std::setw(22) << status << count << "\n";
  }
}

void writeYaml(const EvaluationReport& report, std::ostream& out) {
  out << "alignment: " << toString(report.mode) << "\n";
  out << std::setprecision(std::numeric_limits<double>::max_digits10);
  out << "scale: " << report.alignment.scale << "\n";
  out << "relative_interval: " << report.relative_interval << "\n";
  writeYamlStatistics(out, "", "ate", report.absolute);
  writeYamlStatistics(out, "", "rotation", report.rotation);
  writeYamlStatistics(out, "", "rpe_translation", report.relative_translation);
  writeYamlStatistics(out, "", "rpe_rotation", report.relative_rotation);
  if (report.exposure) {
    out << "exposure:\n";
    writeYamlStatistics(out, "  ", "direction", report.exposure->direction);
    writeYamlStatistics(out, "  ", "length_ratio", report.exposure->length_ratio);
    writeYamlStatistics(out, "  ", "length_error", report.exposure->length_error);
    out << "  reversed: " << report.exposure->reversed << "\n";
  }
  const FrameDrops& drops = report.drops;
  out << "frames: " << drops.frames << "\n";
  out << "dropped: " << drops.dropped << "\n";
  out << "dropped_percent: " << percent(drops.dropped, drops.frames) << "\n";
  out << "frames_after_initialization: " << drops.frames_after_initialization << "\n";
  out << "dropped_after_initialization: " << drops.dropped_after_initialization << "\n";
  out << "dropped_after_initialization_percent: "
      << percent(drops.dropped_after_initialization, drops.frames_after_initialization) << "\n";
  out << "maps: " << report.maps << "\n";
  out << "poses_in_other_maps: " << report.poses_in_other_maps << "\n";
  out << "unmatched_estimates: " << report.unmatched_estimates << "\n";
  if (!report.frames_by_status.empty()) {
    out << "frames_by_status:\n";
    for (const auto& [status, count] : report.frames_by_status) {
      out << "  " << status << ": " << count << "\n";
    }
  }
}

}  // namespace mba_vo
