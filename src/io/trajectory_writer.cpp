#include "mba_vo/io/trajectory_writer.h"

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace mba_vo {
namespace {

void writePose(const SE3& T, std::ostream& out) {
  const Eigen::Vector3d& t = T.translation();
  const Eigen::Quaterniond& q = T.rotation();
  for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) {
    out << " " << value;
  }
}

}  // namespace

std::string formatSeconds(std::int64_t nanoseconds) {
  constexpr std::int64_t kNanosecondsPerSecond = 1000000000;
  const std::int64_t whole = nanoseconds / kNanosecondsPerSecond;
  const std::int64_t rest = nanoseconds % kNanosecondsPerSecond;
  std::ostringstream text;
  text << (nanoseconds < 0 ? "-" : "") << (whole < 0 ? -whole : whole) << "." << std::setw(9) << std::setfill('0')
       << (rest < 0 ? -rest : rest);
  return text.str();
}

PoseLines::PoseLines(std::ostream& out, const std::string& what) : out_(out) {
  out_ << "# " << what << " at mid-exposure, optical frame: t[s] tx ty tz qx qy qz qw\n"
       << std::fixed << std::setprecision(9);
}

void PoseLines::write(std::int64_t mid_exposure_ns, MapId map, const SE3& pose) {
  if (std::exchange(last_map_, map) != map) out_ << "# map " << map << "\n";
  out_ << formatSeconds(mid_exposure_ns);
  writePose(pose, out_);
  out_ << "\n";
}

ExposureLines::ExposureLines(std::ostream& out, const std::string& what) : out_(out) {
  out_ << "# " << what
       << ", optical frame: t_mid[s] exposure[s] then start pose and end pose, each tx ty tz qx qy qz qw\n"
       << std::fixed << std::setprecision(9);
}

void ExposureLines::write(std::int64_t mid_exposure_ns, MapId map, const ExposureTrajectory& trajectory) {
  if (std::exchange(last_map_, map) != map) out_ << "# map " << map << "\n";
  out_ << formatSeconds(mid_exposure_ns) << " " << trajectory.exposure;
  writePose(trajectory.start(), out_);
  writePose(trajectory.end(), out_);
  out_ << "\n";
}

void writeTrajectory(const std::vector<TrajectoryEntry>& entries, std::ostream& out) {
  PoseLines lines(out, "camera to map");
  for (const TrajectoryEntry& entry : entries) {
    lines.write(entry.mid_exposure_ns, entry.map_id, entry.trajectory.T_reference_mid);
  }
}

void writeExposureTrajectory(const std::vector<TrajectoryEntry>& entries, std::ostream& out) {
  ExposureLines lines(out, "camera to map");
  for (const TrajectoryEntry& entry : entries) lines.write(entry.mid_exposure_ns, entry.map_id, entry.trajectory);
}

void writeOnlineTrajectory(const std::vector<FrameRecord>& frames, std::ostream& out) {
  PoseLines lines(out, kOnlineTrajectory);
  for (const FrameRecord& frame : frames) {
    if (frame.online) lines.write(frame.mid_exposure_ns, frame.online->map, frame.online->in_map.T_reference_mid);
  }
}

void writeOnlineExposures(const std::vector<FrameRecord>& frames, std::ostream& out) {
  ExposureLines lines(out, kOnlineTrajectory);
  for (const FrameRecord& frame : frames) {
    if (frame.online) lines.write(frame.mid_exposure_ns, frame.online->map, frame.online->in_map);
  }
}

void writeOnlineOdometry(const std::vector<FrameRecord>& frames, std::ostream& out) {
  PoseLines lines(out, kOnlineOdometry);
  for (const FrameRecord& frame : frames) {
    if (frame.online) lines.write(frame.mid_exposure_ns, frame.online->map, frame.online->T_odom_camera);
  }
}

void writeFile(const std::string& file, const std::function<void(std::ostream&)>& write) {
  errno = 0;
  std::ofstream stream(file);
  if (stream) {
    write(stream);
  }
  if (!stream.flush()) {
    throw std::runtime_error(cannotBeWritten(file));
  }
}

void replaceFile(const std::string& file, const std::function<void(std::ostream&)>& write) {
  const std::string unfinished = file + ".part";
  errno = 0;
  std::ofstream out(unfinished, std::ios::binary);
  if (out) write(out);
  out.close();
  std::error_code error;
  if (out) std::filesystem::rename(unfinished, file, error);
  if (!out || error) throw std::runtime_error(cannotBeWritten(file));
}

std::string cannotBeWritten(const std::string& file) {
  const int reason = errno;
  return file + ": cannot be written" + (reason == 0 ? "" : ": " + std::generic_category().message(reason));
}

}  // namespace mba_vo
