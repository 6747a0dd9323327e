#include <sstream>

#include "mba_vo/evaluation/report_format.h"
#include "mba_vo/evaluation/report_writer.h"
#include "mba_vo/evaluation/run_report_writer.h"
#include "mba_vo/evaluation/statistics.h"

namespace mba_vo {
namespace {

const char* toString(SceneDepth::Source source) {
  switch (source) {
    case SceneDepth::Source::kGiven:
      return "given";
    case SceneDepth::Source::kOnline:
      return "online";
    case SceneDepth::Source::kSmoothed:
      return "smoothed";
    case SceneDepth::Source::kAssumed:
      break;
  }
  return "assumed";
}

/// Stands for a trajectory that cannot be compared, so that every key exists.
EvaluationReport withoutFigures() {
  EvaluationReport report;
  report.alignment.scale = kNone;
  report.absolute = report.rotation = report.relative_translation = report.relative_rotation = summarize({});
  report.maps = 0;
  return report;
}

void writeTrajectory(const std::string& name, const TrajectoryFigures& figures, std::ostream& out) {
  const EvaluationReport report = figures.report.value_or(withoutFigures());
  const std::string indent = "    ";
  out << "  " << name << ":\n";
  out << indent << "scale: " << yamlNumber(report.alignment.scale) << "\n";
  writeYamlStatistics(out, indent, "ate", report.absolute);
  writeYamlStatistics(out, indent, "rotation", report.rotation);
  writeYamlStatistics(out, indent, "rpe_translation", report.relative_translation);
  writeYamlStatistics(out, indent, "rpe_rotation", report.relative_rotation);
  if (report.exposure) {
    writeYamlStatistics(out, indent, "ends", report.exposure->ends);
    writeYamlStatistics(out, indent, "ends_rotation", report.exposure->ends_rotation);
  }
  out << indent << "maps: " << report.maps << "\n";
  out << indent << "poses: " << report.pairs.size() << "\n";
  out << indent << "poses_in_other_maps: " << report.poses_in_other_maps << "\n";
  out << indent << "unmatched_estimates: " << report.unmatched_estimates << "\n";
}

void yamlShare(const std::string& name, const Share& share, std::ostream& out) {
  const double in_percent = share.of == 0 ? kNone : percent(share.count, share.of);
  out << "    " << name << ": {count: " << share.count << ", of: " << share.of
      << ", percent: " << yamlNumber(in_percent) << "}\n";
}

void writeOptional(const std::string& name, const std::optional<double>& value, std::ostream& out) {
  out << "    " << name << ": " << yamlNumber(value.value_or(kNone)) << "\n";
}

void yamlAvailability(const RunReport& report, std::ostream& out) {
  const Availability& a = report.availability;
  out << "  availability:\n";
  writeOptional("frame_interval", a.frame_interval, out);
  writeOptional("depth", report.depth.metres, out);
  out << "    depth_source: " << toString(report.depth.source) << "\n";
  writeOptional("parallax_time", report.parallax_time, out);
  yamlShare("pose_in_time", a.pose_in_time, out);
  yamlShare("pose_in_time_moving", a.pose_in_time_moving, out);
  yamlShare("orientation_in_time", a.orientation_in_time, out);
  yamlShare("orientation_in_time_moving", a.orientation_in_time_moving, out);
  writeOptional("first_pose_after_start", a.first_pose_after_start, out);
  writeOptional("first_pose_after_parallax", a.first_pose_after_parallax, out);
  writeOptional("longest_gap", a.longest_gap, out);
  yamlShare("missed_after_first", a.missed_after_first, out);
  constexpr double kMilliseconds = 1e3;
  out << "    latency_ms: {median: " << yamlNumber(kMilliseconds * a.latency.median)
      << ", percentile_95: " << yamlNumber(kMilliseconds * a.latency.percentile_95)
      << ", percentile_99: " << yamlNumber(kMilliseconds * a.latency.percentile_99) << "}\n";
  out << "    logged_without_pose: " << report.logged_without_pose << "\n";
  out << "    images_by_status:\n";
  for (const auto& [status, count] : a.images_by_status) {
    out << "      " << status << ": " << count << "\n";
  }
}

void yamlConsistency(const Consistency& consistency, std::ostream& out) {
  out << "  consistency:\n    map: " << consistency.map << "\n";
  out << "    first_map: " << (consistency.first_map ? "true" : "false") << "\n";
  out << "    scale: " << yamlNumber(consistency.scale) << "\n";
  for (const NeesSample& s : consistency.samples) {
    std::ostringstream seconds;  // in the key: 1, 5, 10, 0.5
    seconds << s.after;
    out << "    nees_" << seconds.str() << ": {total: " << yamlNumber(s.total)
        << ", translation: " << yamlNumber(s.translation) << ", rotation: " << yamlNumber(s.rotation)
        << ", position_error: " << yamlNumber(s.position_error) << ", position_sigma: " << yamlNumber(s.position_sigma)
        << ", rotation_error: " << yamlNumber(s.rotation_error) << ", rotation_sigma: " << yamlNumber(s.rotation_sigma)
        << "}\n";
  }
}

}  // namespace

void writeRunYaml(const RunReport& report, std::ostream& out) {
  out << "causal:\n  restarts: " << report.restarts << "\n";
  out << "  alignment: " << toString(report.mode) << "\n";
  writeTrajectory("map", report.trajectory, out);
  writeTrajectory("odometry", report.odometry, out);
  yamlAvailability(report, out);
  yamlConsistency(report.consistency, out);
  out << "smoothed:\n";
  out << "  restarts: " << report.restarts << "\n";
  writeYaml(report.smoothed.report.value_or(withoutFigures()), out, "  ");
}

}  // namespace mba_vo
