#include "mba_vo/io/trajectory_writer.h"

#include <fstream>
#include <iomanip>
#include <optional>
#include <sstream>
#include <stdexcept>

namespace mba_vo {
namespace {

void writePose(const SE3& T, std::ostream& out) {
  const Eigen::Vector3d& t = T.translation();
  const Eigen::Quaterniond& q = T.rotation();
  for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) {
    out << " " << value;
  }
}

/// Writes `# map N` whenever the map changes.
class MapComment {
 public:
  void write(MapId map, std::ostream& out) {
    if (map != last_) {
      out << "# map " << map << "\n";
      last_ = map;
    }
  }

 private:
  std::optional<MapId> last_;
};

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

void writeTrajectory(const std::vector<TrajectoryEntry>& entries, std::ostream& out) {
  out << "# camera to map at mid-exposure, optical frame: t[s] tx ty tz qx qy qz qw\n"
      << std::fixed << std::setprecision(9);
  MapComment comment;
  for (const TrajectoryEntry& entry : entries) {
    comment.write(entry.map_id, out);
    out << formatSeconds(entry.mid_exposure_ns);
    writePose(entry.trajectory.T_reference_mid, out);
    out << "\n";
  }
}

void writeExposureTrajectory(const std::vector<TrajectoryEntry>& entries, std::ostream& out) {
  out << "# t_mid[s] exposure[s] then start pose and end pose (camera to map, optical frame), each tx ty tz qx qy qz "
         "qw\n"
      << std::fixed << std::setprecision(9);
  MapComment comment;
  for (const TrajectoryEntry& entry : entries) {
    comment.write(entry.map_id, out);
    out << formatSeconds(entry.mid_exposure_ns) << " " << entry.trajectory.exposure;
    writePose(entry.trajectory.start(), out);
    writePose(entry.trajectory.end(), out);
    out << "\n";
  }
}

void writeFile(const std::string& file, const std::function<void(std::ostream&)>& write) {
  std::ofstream stream(file);
  if (stream) {
    write(stream);
  }
  if (!stream.flush()) {
    throw std::runtime_error(file + ": cannot be written");
  }
}

}  // namespace mba_vo
