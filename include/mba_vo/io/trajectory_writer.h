#pragma once

#include <cstdint>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "mba_vo/mapping/mapper.h"

namespace mba_vo {

/// TUM form: `t tx ty tz qx qy qz qw`, camera to map at mid-exposure. A comment `# map N` stands before the first pose
/// and wherever the map changes: poses of different maps share neither coordinates nor scale.
void writeTrajectory(const std::vector<TrajectoryEntry>& entries, std::ostream& out);

/// `t_mid exposure` + start pose + end pose, each `tx ty tz qx qy qz qw`; maps as in writeTrajectory.
void writeExposureTrajectory(const std::vector<TrajectoryEntry>& entries, std::ostream& out);

/// Seconds with nine decimals, exact.
std::string formatSeconds(std::int64_t nanoseconds);

/// Makes `file` of what `write` puts into the stream. Throws std::runtime_error naming the file if that fails.
void writeFile(const std::string& file, const std::function<void(std::ostream&)>& write);

}  // namespace mba_vo
