#include "mba_vo/datasets/ground_truth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "forms.h"
#include "mba_vo/evaluation/csv_file.h"
#include "mba_vo/io/text_lines.h"

namespace mba_vo {
namespace {

namespace fs = std::filesystem;

/// Where the columns of a data.csv are. Their names are followed by units in brackets.
class AslColumns {
 public:
  explicit AslColumns(const CsvTable& table) {
    // Those of the camera's or of an imu's data.csv are named otherwise, and some trackers know positions only.
    constexpr std::array<const char*, 7> kNames{"p_RS_R_x", "p_RS_R_y", "p_RS_R_z", "q_RS_w",
                                                "q_RS_x",   "q_RS_y",   "q_RS_z"};
    for (std::size_t i = 0; i < kNames.size(); ++i) at_[i] = find(table, kNames[i]);
  }

  /// Body or sensor to world.
  SE3 pose(const CsvTable& table, std::size_t row) const {
    std::array<double, 7> v{};
    for (std::size_t i = 0; i < v.size(); ++i) {
      v[i] = parseFinite(table.rows[row][at_[i]], "value", table.where(row));
    }
    const Eigen::Quaterniond q(v[3], v[4], v[5], v[6]);
    constexpr double kTolerance = 1e-2;  // files carry as few as four decimals
    if (std::abs(q.norm() - 1.0) > kTolerance) {
      throw std::runtime_error(table.where(row) + ": quaternion has norm " + std::to_string(q.norm()) + ", must be 1");
    }
    return {q, {v[0], v[1], v[2]}};
  }

 private:
  static std::size_t find(const CsvTable& table, const std::string& name) {
    for (std::size_t i = 0; i < table.header.size(); ++i) {
      const std::size_t begin = table.header[i].find_first_not_of(" #");
      if (begin != std::string::npos && table.header[i].compare(begin, name.size(), name) == 0) return i;
    }
    throw std::runtime_error(table.file + ":1: no column '" + name +
                             "'; a true trajectory with position and orientation is needed");
  }

  std::array<std::size_t, 7> at_{};
};

/// Where the camera is on the body.
SE3 cameraOnBody(const AslFolders& folders, const GroundTruthOptions& options) {
  const fs::path file = options.calibration_file.empty() ? aslCameraFile(folders) : fs::path(options.calibration_file);
  const std::string name = options.camera.empty() ? folders.camera.filename().string() : options.camera;
  const auto T_body_camera = readCameraFile(file.string(), name).T_body_camera;
  if (T_body_camera) return *T_body_camera;
  throw std::runtime_error(file.string() +
                           ": does not tell where the camera is on the body: T_BS or T_cam_imu is missing; name a file "
                           "that does with --calibration");
}

std::vector<PoseRecord> readAsl(const fs::path& file, const GroundTruthOptions& options) {
  const CsvTable table = readCsv(file.string());
  const AslColumns columns(table);
  const fs::path mav = fs::weakly_canonical(file).parent_path().parent_path();
  const fs::path camera = mav / (options.camera.empty() ? "cam0" : options.camera);
  const SE3 T_body_camera = cameraOnBody({mav.parent_path(), camera}, options);
  const fs::path sensor = file.parent_path() / "sensor.yaml";
  const SE3 T_body_sensor = fs::exists(sensor) ? readSensorPose(sensor.string()).value_or(SE3()) : SE3();
  const SE3 T_sensor_camera = T_body_sensor.inverse() * T_body_camera;
  std::vector<PoseRecord> records;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    PoseRecord record;
    record.time = 1e-9 * static_cast<double>(parseNanoseconds(table.rows[row].front(), table.where(row)));
    record.T_world_camera = columns.pose(table, row) * T_sensor_camera;
    records.push_back(record);
  }
  if (records.empty()) throw std::runtime_error(file.string() + ": contains no pose");
  std::stable_sort(records.begin(), records.end(),
                   [](const PoseRecord& a, const PoseRecord& b) { return a.time < b.time; });
  return records;
}

std::vector<PoseRecord> readSevenScenes(const std::vector<NumberedFile>& files) {
  std::vector<PoseRecord> records;
  for (const NumberedFile& pose : files) {
    const std::string name = pose.file.string();
    std::vector<double> values;
    for (const TextLine& line : splitLines(readText(name), name)) {
      for (const std::string& word : line.words) values.push_back(parseFinite(word, "value", line.where));
    }
    constexpr std::size_t kMatrix = 16;
    if (values.size() != kMatrix) {
      throw std::runtime_error(name + ": " + std::to_string(values.size()) + " values, must be 16: 4 rows of 4");
    }
    PoseRecord record;
    record.time = 1e-9 * static_cast<double>(sevenScenesTime(pose.number));
    try {
      record.T_world_camera = poseOfMatrix(values);
    } catch (const std::invalid_argument& error) {
      throw std::runtime_error(name + ": the pose must be " + error.what());
    }
    records.push_back(record);
  }
  return records;
}

constexpr std::array<const char*, 5> kTruths{"groundtruth.txt", "groundtruthSync.txt",
                                             "mav0/state_groundtruth_estimate0/data.csv", "mav0/mocap0/data.csv",
                                             "mav0/vicon0/data.csv"};

/// The first of kTruths in the folder; empty if there is none.
fs::path truthFile(const fs::path& folder) {
  for (const char* name : kTruths) {
    if (fs::exists(folder / name)) return folder / name;
  }
  return {};
}

std::vector<PoseRecord> readFolder(const fs::path& folder, const GroundTruthOptions& options) {
  const std::vector<NumberedFile> poses = sevenScenesFiles(folder, ".pose");
  if (!poses.empty()) return readSevenScenes(poses);
  const fs::path file = truthFile(folder);
  if (!file.empty()) return readGroundTruth(file.string(), options);
  std::string tried = "frame-000000.pose.txt";
  for (const char* name : kTruths) tried += std::string(", ") + name;
  throw std::runtime_error(folder.string() + ": no ground truth, none of " + tried);
}

}  // namespace

bool hasGroundTruth(const std::string& folder) {
  return !truthFile(folder).empty() || !sevenScenesFiles(folder, ".pose").empty();
}

std::vector<PoseRecord> readGroundTruth(const std::string& path, const GroundTruthOptions& options) {
  if (fs::is_directory(path)) return readFolder(path, options);
  if (fs::path(path).extension() == ".csv") return readAsl(path, options);
  return readPoseFile(path);
}

}  // namespace mba_vo
