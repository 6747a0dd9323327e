#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "mba_vo/io/run_log.h"
#include "mba_vo/mapping/mapper.h"

namespace mba_vo {

/// TUM form: `t tx ty tz qx qy qz qw`, camera to map at mid-exposure. A comment `# map N` stands before the first pose
/// and wherever the map changes: poses of different maps share neither coordinates nor scale.
void writeTrajectory(const std::vector<TrajectoryEntry>& entries, std::ostream& out);

/// `t_mid exposure` + start pose + end pose, each `tx ty tz qx qy qz qw`; maps as in writeTrajectory.
void writeExposureTrajectory(const std::vector<TrajectoryEntry>& entries, std::ostream& out);

/// Writes poses one by one, in the form of writeTrajectory.
class PoseLines {
 public:
  /// `what`: of the poses, for the comment at the top.
  PoseLines(std::ostream& out, const std::string& what);
  void write(std::int64_t mid_exposure_ns, MapId map, const SE3& pose);

 private:
  std::ostream& out_;
  std::optional<MapId> last_map_;
};

/// The same in the form of writeExposureTrajectory.
class ExposureLines {
 public:
  ExposureLines(std::ostream& out, const std::string& what);
  void write(std::int64_t mid_exposure_ns, MapId map, const ExposureTrajectory& trajectory);

 private:
  std::ostream& out_;
  std::optional<MapId> last_map_;
};

inline constexpr const char* kOnlineTrajectory = "as first published: camera to map";
inline constexpr const char* kOnlineOdometry = "as first published: camera to odom";

/// What was published, when it was published: the pose of each image as it was first told, camera to map, in the form
/// of writeTrajectory.
void writeOnlineTrajectory(const std::vector<FrameRecord>& frames, std::ostream& out);
/// With the poses at the start and at the end of its exposure, in the form of writeExposureTrajectory.
void writeOnlineExposures(const std::vector<FrameRecord>& frames, std::ostream& out);
/// The same at mid-exposure, camera to odom, which is continuous; the comment `# map N` tells where the unit of length
/// changes.
void writeOnlineOdometry(const std::vector<FrameRecord>& frames, std::ostream& out);

/// Seconds with nine decimals, exact.
std::string formatSeconds(std::int64_t nanoseconds);

/// Makes `file` of what `write` puts into the stream. Throws std::runtime_error naming the file and the reason (a full
/// disk, permissions) if that fails.
void writeFile(const std::string& file, const std::function<void(std::ostream&)>& write);

/// The same, with `file` whole at any time: it is written beside its place, as FILE.part, and then moved there.
void replaceFile(const std::string& file, const std::function<void(std::ostream&)>& write);

/// "FILE: cannot be written", with the reason that the system gave for the last call that failed, if errno has one. To
/// be set to 0 before.
std::string cannotBeWritten(const std::string& file);

}  // namespace mba_vo
