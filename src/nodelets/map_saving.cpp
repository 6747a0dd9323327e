#include "map_saving.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>

#include "mba_vo/io/map_file.h"
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

std::filesystem::path mapFile(const std::string& folder, const std::string& name) {
  return std::filesystem::absolute(folder) / (name.empty() ? "map.mba_vo" : name);
}

}  // namespace

std::string saveTrajectory(const std::string& folder, MapperWorker& worker, std::chrono::seconds timeout) {
  const std::vector<TrajectoryEntry> trajectory =
      waitFor(worker.ask([](const Mapper& mapper) { return mapper.finishedTrajectory(); }), timeout);
  if (trajectory.empty()) throw std::runtime_error("there is no pose to save: no image has been tracked yet");
  const std::filesystem::path place = makeFolder(folder);
  writeFile((place / "trajectory.txt").string(), [&](std::ostream& out) { writeTrajectory(trajectory, out); });
  writeFile((place / "exposure_trajectory.txt").string(),
            [&](std::ostream& out) { writeExposureTrajectory(trajectory, out); });
  return std::to_string(trajectory.size()) + " poses written to " + place.string();
}

std::string savePoints(const std::string& folder, MapperWorker& worker, std::chrono::seconds timeout) {
  const std::vector<MapPoint> points =
      waitFor(worker.ask([](const Mapper& mapper) { return mapper.points(); }), timeout);
  if (points.empty()) throw std::runtime_error("there is no map yet");
  const std::string file = (makeFolder(folder) / "points.ply").string();
  writeFile(file, [&](std::ostream& out) { writePointsPly(points, out); });
  return std::to_string(points.size()) + " points written to " + file;
}

std::string saveMap(const std::string& folder, const std::string& name, MapperWorker& worker,
                    std::chrono::seconds timeout) {
  const std::optional<SavedMap> map = waitFor(worker.ask([](const Mapper& m) { return m.savedMap(); }), timeout);
  if (!map) throw std::runtime_error("there is no map yet");
  const std::filesystem::path file = mapFile(folder, name);
  makeFolder(file.parent_path().string());
  writeMap(file.string(), *map);
  return std::to_string(map->keyframes.size()) + " keyframes written to " + file.string();
}

std::string loadMap(const std::string& folder, const std::string& name, MapperWorker& worker) {
  const std::string file = mapFile(folder, name).string();
  const auto map = std::make_shared<SavedMap>(readMap(file));
  worker.beginIn(map);
  return "the camera is looked for in " + file + ", " + std::to_string(map->keyframes.size()) + " keyframes";
}

}  // namespace mba_vo
