#include "mba_vo/evaluation/report_writer.h"

#include <iomanip>

#include "mba_vo/evaluation/report_format.h"

namespace mba_vo {
namespace {

constexpr int kRunNameWidth = 22;

void writeDrops(std::ostream& out, const std::string& name, std::size_t dropped, std::size_t frames) {
  out << "  " << std::left << std::setw(kRunNameWidth) << name << dropped << " of " << frames << " ("
      << fixedText(percent(dropped, frames), 1) << " %)\n";
}

void writeErrors(const EvaluationReport& report, std::ostream& out) {
  constexpr int kMillimetreHundredths = 5;
  constexpr int kDecimals = 3;  // of degrees and ratios
  const std::string interval = " over " + fixedText(report.relative_interval, 2) + " s";
  writeStatisticsHeader(out);
  writeStatisticsRow(out, "ATE [m]", report.absolute, kMillimetreHundredths);
  writeStatisticsRow(out, "rotation [deg]", report.rotation, kDecimals);
  writeStatisticsRow(out, "RPE" + interval + ", translation [m]", report.relative_translation, kMillimetreHundredths);
  writeStatisticsRow(out, "RPE" + interval + ", rotation [deg]", report.relative_rotation, kDecimals);
  if (report.exposure) {
    writeStatisticsRow(out, "start and end, ATE [m]", report.exposure->ends, kMillimetreHundredths);
    writeStatisticsRow(out, "start and end, rotation [deg]", report.exposure->ends_rotation, kDecimals);
    writeStatisticsRow(out, "within the exposure, direction [deg]", report.exposure->direction, kDecimals);
    writeStatisticsRow(out, "within the exposure, length ratio", report.exposure->length_ratio, kDecimals);
    writeStatisticsRow(out, "within the exposure, |ratio - 1|", report.exposure->length_error, kDecimals);
    out << "  estimated backwards   " << report.exposure->reversed << " of " << report.exposure->direction.count
        << " frames with enough blur\n";
  }
}

void writeYamlDrops(const FrameDrops& drops, const std::string& indent, std::ostream& out) {
  out << indent << "frames: " << drops.frames << "\n";
  out << indent << "dropped: " << drops.dropped << "\n";
  out << indent << "dropped_percent: " << yamlNumber(percent(drops.dropped, drops.frames)) << "\n";
  out << indent << "frames_after_initialization: " << drops.frames_after_initialization << "\n";
  out << indent << "dropped_after_initialization: " << drops.dropped_after_initialization << "\n";
  out << indent << "dropped_after_initialization_percent: "
      << yamlNumber(percent(drops.dropped_after_initialization, drops.frames_after_initialization)) << "\n";
}

}  // namespace

void writeTable(const EvaluationReport& report, std::ostream& out) {
  out << "alignment " << toString(report.mode) << ", scale " << std::setprecision(6) << report.alignment.scale
      << " (true / estimated length), " << report.pairs.size() << " poses compared\n\n";
  writeErrors(report, out);
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
  if (!report.clock_hint.empty()) {
    out << "  " << report.clock_hint << "\n";
  }
  for (const auto& [status, count] : report.frames_by_status) {
    out << "  " << std::left << std::setw(kRunNameWidth) << status << count << "\n";
  }
}

void writeYaml(const EvaluationReport& report, std::ostream& out, const std::string& indent) {
  out << indent << "alignment: " << toString(report.mode) << "\n";
  out << indent << "scale: " << yamlNumber(report.alignment.scale) << "\n";
  out << indent << "relative_interval: " << yamlNumber(report.relative_interval) << "\n";
  writeYamlStatistics(out, indent, "ate", report.absolute);
  writeYamlStatistics(out, indent, "rotation", report.rotation);
  writeYamlStatistics(out, indent, "rpe_translation", report.relative_translation);
  writeYamlStatistics(out, indent, "rpe_rotation", report.relative_rotation);
  if (report.exposure) {
    out << indent << "exposure:\n";
    writeYamlStatistics(out, indent + "  ", "ends", report.exposure->ends);
    writeYamlStatistics(out, indent + "  ", "ends_rotation", report.exposure->ends_rotation);
    writeYamlStatistics(out, indent + "  ", "direction", report.exposure->direction);
    writeYamlStatistics(out, indent + "  ", "length_ratio", report.exposure->length_ratio);
    writeYamlStatistics(out, indent + "  ", "length_error", report.exposure->length_error);
    out << indent << "  reversed: " << report.exposure->reversed << "\n";
  }
  writeYamlDrops(report.drops, indent, out);
  out << indent << "maps: " << report.maps << "\n";
  out << indent << "poses_in_other_maps: " << report.poses_in_other_maps << "\n";
  out << indent << "unmatched_estimates: " << report.unmatched_estimates << "\n";
  if (!report.frames_by_status.empty()) {
    out << indent << "frames_by_status:\n";
    for (const auto& [status, count] : report.frames_by_status) {
      out << indent << "  " << status << ": " << count << "\n";
    }
  }
}

}  // namespace mba_vo
