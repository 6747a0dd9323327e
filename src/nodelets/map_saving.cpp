#include "map_saving.h"

#include <filesystem>
#include <stdexcept>

#include "mba_vo/io/points_file.h"
#include "mba_vo/io/trajectory_writer.h"

namespace mba_vo {
namespace {

template <typename Value>
Value waitFor(std::future<Value> future, std::chrono::seconds timeout) {
  if (future.wait_for(timeout) != std::future_status::ready) {
    throw std::runtime_error("the mapper is still busy after " + std::to_string(timeout.count()) + " s");
  }
  return future.get();
}

std::filesystem::path makeFolder(const std::string& name) {
  const std::filesystem::path folder = std::filesystem::absolute(name);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw std::runtime_error("folder '" + folder.string() + "' cannot be made: " + error.message());
  return folder;
}

}  // namespace

std::string saveTrajectory(const std::string& folder, MapperWorker& worker, std::chrono::seconds timeout) {
  const std::vector<TrajectoryEntry> trajectory = waitFor(worker.trajectory(), timeout);
  if (trajectory.empty()) throw std::runtime_error("there is no pose to save: no image has been tracked yet");
  const std::filesystem::path place = makeFolder(folder);
  writeFile((place / "trajectory.txt").string(), [&](std::ostream& out) { writeTrajectory(trajectory, out); });
  writeFile((place / "exposure_trajectory.txt").string(),
            [&](std::ostream& out) { writeExposureTrajectory(trajectory, out); });
  return std::to_string(trajectory.size()) + " poses written to " + place.string();
}

std::string savePoints(const std::string& folder, MapperWorker& worker, std::chrono::seconds timeout) {
  const std::vector<MapPoint> points = waitFor(worker.points(), timeout);
  if (points.empty()) throw std::runtime_error("there is no map yet");
  const std::string file = (makeFolder(folder) / "points.ply").string();
  writeFile(file, [&](std::ostream& out) { writePointsPly(points, out); });
  return std::to_string(points.size()) + " points written to " + file;
}

}  // namespace mba_vo
