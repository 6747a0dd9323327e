#include <iomanip>

#include "mba_vo/evaluation/report_format.h"
#include "mba_vo/evaluation/report_writer.h"
#include "mba_vo/evaluation/run_report_writer.h"
#include "mba_vo/evaluation/statistics.h"

namespace mba_vo {
namespace {

void writeHeading(const std::string& title, int restarts, std::ostream& out) {
  out << title;
  if (restarts > 0) {
    out << " (after " << restarts << (restarts == 1 ? " restart" : " restarts")
        << " with what was learnt: not causal in one pass)";
  }
  out << "\n";
}

std::ostream& writeName(std::ostream& out, const std::string& name) {
  constexpr int kTableNameWidth = 42;
  return out << "  " << std::left << std::setw(kTableNameWidth) << name;
}

void writeShare(const std::string& name, const Share& share, std::ostream& out) {
  writeName(out, name) << share.count << " of " << share.of;
  if (share.of > 0) {
    out << " (" << fixedText(percent(share.count, share.of), 1) << " %)";
  }
  out << "\n";
}

void writeSeconds(const std::string& name, const std::optional<double>& seconds, std::ostream& out) {
  writeName(out, name) << fixedText(seconds.value_or(kNone), 3) << "\n";
}

void writeErrors(const std::string& name, const TrajectoryFigures& figures, std::ostream& out) {
  const Statistics none = summarize({});
  constexpr int kMillimetreHundredths = 5;
  constexpr int kDegreeDecimals = 3;
  writeStatisticsRow(out, name + ", ATE [m]", figures.report ? figures.report->absolute : none, kMillimetreHundredths);
  writeStatisticsRow(out, name + ", rotation [deg]", figures.report ? figures.report->rotation : none, kDegreeDecimals);
  if (!figures.report || !figures.report->exposure) return;
  const ExposureEvaluation& exposure = *figures.report->exposure;
  writeStatisticsRow(out, "  start and end, ATE [m]", exposure.ends, kMillimetreHundredths);
  writeStatisticsRow(out, "  start and end, rotation [deg]", exposure.ends_rotation, kDegreeDecimals);
}

void writeOrigin(const std::string& name, const TrajectoryFigures& figures, std::ostream& out) {
  out << "  " << name << ": ";
  if (!figures.report) {
    out << figures.unavailable << "\n";
    return;
  }
  const EvaluationReport& report = *figures.report;
  out << "alignment " << toString(report.mode) << ", scale " << std::setprecision(6) << report.alignment.scale
      << " (true / estimated length), " << report.pairs.size() << " poses compared; ";
  out << report.maps << (report.maps == 1 ? " map" : " maps");
  if (report.maps > 1) {
    out << ", the largest, " << report.map << ", is evaluated, " << report.poses_in_other_maps
        << " poses are in the others";
  }
  if (report.unmatched_estimates > 0) {
    out << "; " << report.unmatched_estimates << " poses have no ground truth";
  }
  out << "\n";
  if (!report.clock_hint.empty()) {
    out << "  " << report.clock_hint << "\n";
  }
}

std::string describe(const RunReport& report) {
  const std::string metres = fixedText(report.depth.metres, 2) + " m, ";
  switch (report.depth.source) {
    case SceneDepth::Source::kGiven:
      return metres + "as given";
    case SceneDepth::Source::kOnline:
      return metres + "scale of the published poses";
    case SceneDepth::Source::kSmoothed:
      return metres + "scale of the smoothed trajectory";
    case SceneDepth::Source::kAssumed:
      break;
  }
  return metres + "assumed, because " +
         (report.metric ? "the map is in metres and its scale does not tell: --depth does"
                        : "no trajectory tells its scale: --depth does");
}

void writeAvailability(const RunReport& report, std::ostream& out) {
  const Availability& a = report.availability;
  out << "in time: at most one frame interval, " << fixedText(1e3 * a.frame_interval, 1)
      << " ms, after the image came in; moving: later than 0.3 s after 2 % of parallax\n"
      << "(median depth " << describe(report) << ")\n";
  writeShare("images with a pose in time", a.pose_in_time, out);
  writeShare("  moving", a.pose_in_time_moving, out);
  writeShare("at least an orientation in time", a.orientation_in_time, out);
  writeShare("  moving", a.orientation_in_time_moving, out);
  writeSeconds("first pose after the first image [s]", a.first_pose_after_start, out);
  writeSeconds("first pose after 2 % of parallax [s]", a.first_pose_after_parallax, out);
  writeSeconds("longest gap after the first pose [s]", a.longest_gap, out);
  writeShare("images without, after the first pose", a.missed_after_first, out);
  writeName(out, "latency of poses, 50 / 95 / 99 % [ms]")
      << fixedText(1e3 * a.latency.median, 1) << " / " << fixedText(1e3 * a.latency.percentile_95, 1) << " / "
      << fixedText(1e3 * a.latency.percentile_99, 1) << "\n";
  for (const auto& [status, count] : a.images_by_status) {
    writeName(out, status) << count << "\n";
  }
  if (report.logged_without_pose > 0) {
    out << "  " << report.logged_without_pose
        << " images have a pose by frames.csv, which is believed here, but none in online_odometry.txt\n";
  }
}

void writeConsistency(const Consistency& consistency, std::ostream& out) {
  out << "covariance of the odometry: squared error over what it expects, per degree of freedom (1 is right)\n"
      << "(map " << consistency.map << ", metres per unit from the first 2 s: " << fixedText(consistency.scale, 4)
      << ")\n"
      << std::right << std::setw(10) << "after [s]" << std::setw(10) << "NEES/6" << std::setw(15) << "translation/3"
      << std::setw(12) << "rotation/3" << std::setw(12) << "error [m]" << std::setw(14) << "expected [m]"
      << std::setw(13) << "error [deg]" << std::setw(16) << "expected [deg]"
      << "\n";
  for (const NeesSample& s : consistency.samples) {
    out << std::right << std::setw(10) << fixedText(s.after, 1);
    if (!s.unavailable.empty()) {
      out << "  " << s.unavailable << "\n";
      continue;
    }
    out << std::setw(10) << fixedText(s.total, 3) << std::setw(15) << fixedText(s.translation, 3) << std::setw(12)
        << fixedText(s.rotation, 3) << std::setw(12) << fixedText(s.position_error, 4) << std::setw(14)
        << fixedText(s.position_sigma, 4) << std::setw(13) << fixedText(s.rotation_error, 3) << std::setw(16)
        << fixedText(s.rotation_sigma, 3) << "\n";
  }
  if (!consistency.first_map) {
    out << "  another map came before: the covariance includes what the odometry did in it\n";
  }
}

}  // namespace

void writeRunTable(const RunReport& report, std::ostream& out) {
  writeHeading("causal: as published when it was published", report.restarts, out);
  writeStatisticsHeader(out);
  writeErrors("map", report.trajectory, out);
  writeErrors("odometry", report.odometry, out);
  writeOrigin("map", report.trajectory, out);
  writeOrigin("odometry", report.odometry, out);
  out << "\n";
  writeHeading("causal: availability", report.restarts, out);
  writeAvailability(report, out);
  out << "\n";
  writeHeading("causal: consistency", report.restarts, out);
  writeConsistency(report.consistency, out);
  out << "\n";
  writeHeading("smoothed: the trajectory saved at the end", report.restarts, out);
  if (report.smoothed.report) {
    writeTable(*report.smoothed.report, out);
  } else {
    out << "  " << report.smoothed.unavailable << "\n";
  }
}

}  // namespace mba_vo
