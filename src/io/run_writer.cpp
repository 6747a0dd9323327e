#include "mba_vo/io/run_writer.h"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <sstream>
#include <stdexcept>

#include "mba_vo/image/static_overlay.h"
#include "mba_vo/io/frames_csv.h"
#include "mba_vo/io/loops_csv.h"
#include "mba_vo/io/points_file.h"
#include "mba_vo/io/trajectory_writer.h"
#include "mba_vo/odometry/config_yaml.h"

namespace mba_vo {
namespace {

using Correction = CalibrationCorrection;

/// For YAML, where a backslash escapes.
std::string yamlQuoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    result += (c == '"' || c == '\\' ? "\\" : "") + std::string(1, c == '\n' ? ' ' : c);
  }
  return result + "\"";
}

void writeCalibration(const OfflineResult& result, std::ostream& out) {
  const Correction& c = result.correction;
  out << "restarts: " << result.restarts << "\n";
  out << "calibration_correction: {focal: " << c[Correction::kFocal] << ", centre_x: " << c[Correction::kCentreX]
      << ", centre_y: " << c[Correction::kCentreY] << ", k1: " << c[Correction::kK1] << ", k2: " << c[Correction::kK2]
      << ", readout_time: " << c[Correction::kReadout] << ", vignette: [" << c[Correction::kV1] << ", "
      << c[Correction::kV2] << ", " << c[Correction::kV3] << "]}\n";
}

void writeDeblurring(const DeblurCounts& counts, std::ostream& out) {
  if (counts.offered == 0) return;
  out << "deblurring: {offered: " << counts.offered << ", waiting: " << counts.waiting
      << ", sharpened: " << counts.sharpened << ", in_map: " << counts.in_map << ", unsuited: " << counts.unsuited
      << ", passed_over: " << counts.passed_over << ", too_slow: " << counts.too_slow
      << ", forgotten: " << counts.forgotten << ", unsuited_reason: " << yamlQuoted(counts.unsuited_reason) << "}\n";
}

void writeLoopCounts(const std::vector<LoopTrial>& loops, std::ostream& out) {
  if (loops.empty()) return;
  const auto closed =
      std::count_if(loops.begin(), loops.end(), [](const LoopTrial& loop) { return loop.verdict.accepted(); });
  out << "loops: {compared: " << loops.size() << ", closed: " << closed << "}\n";
}

void writeStage(std::ostream& out, const char* name, double seconds, std::size_t frames) {
  const double per_frame = frames == 0 ? 0.0 : 1e3 * seconds / static_cast<double>(frames);
  out << "  " << name << ": {total_s: " << seconds << ", per_frame_ms: " << per_frame << "}\n";
}

void writeProcessorTime(std::ostream& out, double core_seconds, const std::vector<FrameRecord>& frames) {
  const double duration =
      frames.empty() ? 0.0 : 1e-9 * static_cast<double>(frames.back().mid_exposure_ns - frames.front().mid_exposure_ns);
  const double per_second = duration > 0.0 ? core_seconds / duration : 0.0;
  out << "cpu: {total_s: " << core_seconds << ", per_second: " << per_second << "}\n";
}

}  // namespace

void writeKeyframes(const std::vector<KeyframeReport>& keyframes, std::ostream& out) {
  out << "keyframe,sequence,time,blur_px,points,residuals,rms,error_px,depth_search_ms,activation_ms,"
         "optimisation_ms,calibration_ms,marginalisation_ms,selection_ms,total_ms,depths_compared,depths_agreeing\n";
  out << std::fixed << std::setprecision(3);
  for (const KeyframeReport& k : keyframes) {
    out << k.keyframe_id << "," << k.frame_sequence << "," << formatSeconds(k.mid_exposure_ns) << ","
        << k.blur_length_px << "," << k.points << "," << k.residuals << "," << k.rms << "," << k.error_px << ","
        << k.depth_search_ms << "," << k.activation_ms << "," << k.optimisation_ms << "," << k.calibration_ms << ","
        << k.marginalisation_ms << "," << k.selection_ms << "," << k.total_ms << "," << k.depths.compared << ","
        << k.depths.agreeing << "\n";
  }
}

void writeSummary(const OfflineResult& result, const std::vector<std::pair<std::string, std::string>>& settings,
                  std::ostream& out) {
  for (const auto& [name, value] : settings) {
    out << name << ": " << yamlQuoted(value) << "\n";
  }
  const FrameCounts counts = countFrames(result.log.frames());
  out << "frames: " << counts.frames << "\n";
  out << "tracked: " << counts.tracked << "\n";
  out << "repeated: " << counts.repeated << "\n";
  out << "dropped: " << counts.dropped << "\n";
  out << "dropped_after_initialization: " << counts.dropped_after_initialization << "\n";
  out << "rejected: " << counts.rejected << "\n";
  out << "skipped: " << result.skipped << "\n";
  out << "keyframes: " << result.log.keyframes().size() << "\n";
  out << "maps: " << counts.maps << "\n";
  out << "metric_maps: " << counts.metric_maps << "\n";
  writeDeblurring(result.deblurring, out);
  writeLoopCounts(result.loops, out);
  out << "static_overlay: " << shareOf(result.overlay) << "\n";
  writeCalibration(result, out);
  if (std::isfinite(result.exposure.log_sigma)) {
    out << "exposure_ratio: " << result.exposure.ratio << "\n";
    out << "exposure_ratio_sigma: " << result.exposure.log_sigma << "\n";
    out << "exposure_ratio_used: " << (result.exposure.used ? "true" : "false") << "\n";
  }
  const StageTimes& times = result.times;
  out << std::fixed << std::setprecision(3) << "times:\n";
  writeStage(out, "load", times.load, counts.frames);
  writeStage(out, "frame_build", times.frame_build, counts.frames);
  writeStage(out, "tracking", times.tracking, counts.frames);
  writeStage(out, "mapping", times.mapping, counts.frames);
  writeStage(out, "total", times.total, counts.frames);
  writeProcessorTime(out, times.cpu, result.log.frames());
  out << "peak_memory_mb: " << std::setprecision(1) << peakMemoryMegabytes() << "\n";
}

void writeRun(const std::string& folder, const OfflineResult& result,
              const std::vector<std::pair<std::string, std::string>>& settings) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw std::runtime_error(folder + ": cannot be made: " + error.message());
  }
  const std::filesystem::path path(folder);
  const auto write = [&](const char* name, const std::function<void(std::ostream&)>& content) {
    writeFile((path / name).string(), content);
  };
  write("trajectory.txt", [&](std::ostream& out) { writeTrajectory(result.trajectory, out); });
  write("exposure_trajectory.txt", [&](std::ostream& out) { writeExposureTrajectory(result.trajectory, out); });
  write("online_trajectory.txt", [&](std::ostream& out) { writeOnlineTrajectory(result.log.frames(), out); });
  write("online_exposure_trajectory.txt", [&](std::ostream& out) { writeOnlineExposures(result.log.frames(), out); });
  write("online_odometry.txt", [&](std::ostream& out) { writeOnlineOdometry(result.log.frames(), out); });
  write("points.txt", [&](std::ostream& out) { writePoints(result.points, out); });
  write("frames.csv", [&](std::ostream& out) { writeFrames(result.log.frames(), out); });
  write("keyframes.csv", [&](std::ostream& out) { writeKeyframes(result.log.keyframes(), out); });
  if (!result.loops.empty()) write("loops.csv", [&](std::ostream& out) { writeLoops(result.loops, out); });
  write("machine.yaml", [&](std::ostream& out) { writeConfig(result.machine, out); });
  write("summary.yaml", [&](std::ostream& out) { writeSummary(result, settings, out); });
}

double peakMemoryMegabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  constexpr double kKibibytesPerMegabyte = 1e6 / 1024.0;  // Linux counts in KiB
  return static_cast<double>(usage.ru_maxrss) / kKibibytesPerMegabyte;
}

}  // namespace mba_vo
