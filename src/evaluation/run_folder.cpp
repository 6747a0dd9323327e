#include "mba_vo/evaluation/run_folder.h"

#include <filesystem>
#include <fstream>
#include <limits>
#include <stdexcept>

namespace mba_vo {
namespace {

namespace fs = std::filesystem;

/// The whole number behind `name: ` at the beginning of a line; 0 if no line has it.
int readCount(const fs::path& file, const std::string& name) {
  std::ifstream stream(file);
  const std::string key = name + ":";
  int line_number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++line_number;
    if (line.compare(0, key.size(), key) != 0) {
      continue;
    }
    const std::string text = line.substr(std::min(line.size(), line.find_first_not_of(' ', key.size())));
    const std::optional<double> number = finiteNumber(text);
    constexpr double kMost = std::numeric_limits<int>::max();
    if (!number || *number < 0.0 || *number > kMost || *number != static_cast<int>(*number)) {
      throw std::runtime_error(file.string() + ":" + std::to_string(line_number) + ": " + name + " '" + text +
                               "' is not a whole number >= 0");
    }
    return static_cast<int>(*number);
  }
  return 0;
}

std::vector<PoseRecord> readOnlinePoses(const fs::path& file) {
  if (!fs::exists(file)) {
    throw std::runtime_error(file.string() +
                             ": no such file; every run writes it. For a single trajectory use --estimate");
  }
  return readPosesIfAny(file.string());
}

/// Start and end poses, of the images whose poses at mid-exposure are `poses`.
void addExposures(const fs::path& file, std::vector<PoseRecord>& poses) {
  if (!fs::exists(file)) return;  // an earlier version did not write it
  const std::vector<PoseRecord> exposures = readPosesIfAny(file.string());
  if (exposures.size() != poses.size()) {
    throw std::runtime_error(file.string() + ": " + std::to_string(exposures.size()) + " poses, and " +
                             std::to_string(poses.size()) + " in online_trajectory.txt; there must be as many");
  }
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i].exposure = exposures[i].exposure;
}

std::vector<PoseRecord> readSmoothedPoses(const fs::path& folder, PoseForm form) {
  const fs::path exposures = folder / "exposure_trajectory.txt";
  const bool with_exposures = form == PoseForm::kExposures && fs::exists(exposures);
  const fs::path file = with_exposures ? exposures : folder / "trajectory.txt";
  return fs::exists(file) ? readPosesIfAny(file.string()) : std::vector<PoseRecord>();
}

}  // namespace

RunFolder readRunFolder(const std::string& folder, PoseForm form) {
  const fs::path path(folder);
  if (!fs::is_directory(path)) {
    throw std::runtime_error(folder + ": no such folder");
  }
  RunFolder run;
  run.online_trajectory = readOnlinePoses(path / "online_trajectory.txt");
  if (form == PoseForm::kExposures) addExposures(path / "online_exposure_trajectory.txt", run.online_trajectory);
  run.online_odometry = readOnlinePoses(path / "online_odometry.txt");
  run.smoothed = readSmoothedPoses(path, form);
  const CsvTable table = readCsv((path / "frames.csv").string());
  run.online_frames = onlineLog(table);
  run.frames = frameLog(table);
  run.restarts = readCount(path / "summary.yaml", "restarts");
  run.metric = readCount(path / "summary.yaml", "metric_maps") > 0;
  return run;
}

}  // namespace mba_vo
