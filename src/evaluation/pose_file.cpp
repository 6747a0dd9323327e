#include "mba_vo/evaluation/pose_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "mba_vo/evaluation/csv_file.h"

namespace mba_vo {
namespace {

constexpr std::size_t kPoseColumns = 8;
constexpr std::size_t kExposureColumns = 16;
constexpr double kQuaternionTolerance = 1e-2;  // of the norm; files carry as few as four decimals

[[noreturn]] void fail(const std::string& where, const std::string& what) {
  throw std::runtime_error(where + ": " + what);
}

std::vector<double> parseNumbers(const std::string& line, const std::string& where) {
  std::vector<double> numbers;
  std::istringstream words(line);
  for (std::string word; words >> word;) {
    const std::optional<double> value = finiteNumber(word);
    if (!value) {
      fail(where, "'" + word + "' is not a finite number");
    }
    numbers.push_back(*value);
  }
  return numbers;
}

/// A line that tells a time, but that the pose then is unknown: `t nan nan ...`.
bool tellsNoPose(const std::string& line) {
  std::istringstream words(line);
  std::string time;
  words >> time;
  int unknown = 0;
  for (std::string word; words >> word; ++unknown) {
    if (word != "nan" && word != "NaN" && word != "-nan") return false;
  }
  return unknown == kPoseColumns - 1;
}

SE3 parsePose(const double* n, const std::string& where) {
  const Eigen::Quaterniond rotation(n[6], n[3], n[4], n[5]);
  if (std::abs(rotation.norm() - 1.0) > kQuaternionTolerance) {
    fail(where, "quaternion has norm " + std::to_string(rotation.norm()) + ", must be 1");
  }
  return SE3(rotation, Eigen::Vector3d(n[0], n[1], n[2]));
}

PoseRecord parseRecord(const std::vector<double>& n, const std::string& where) {
  PoseRecord record;
  record.time = n[0];
  if (n.size() == kPoseColumns) {
    record.T_world_camera = parsePose(&n[1], where);
    return record;
  }
  if (n[1] < 0.0) {
    fail(where, "exposure " + std::to_string(n[1]) + " s is negative");
  }
  record.exposure = ExposurePoses{n[1], parsePose(&n[2], where), parsePose(&n[9], where)};
  const SE3& start = record.exposure->T_world_start;
  record.T_world_camera = start * SE3::exp(0.5 * (start.inverse() * record.exposure->T_world_end).log());
  return record;
}

/// N of the comment `# map N`.
std::optional<int> mapOfComment(const std::string& comment) {
  std::istringstream words(comment);
  std::string keyword;
  int map = 0;
  if (words >> keyword >> map && keyword == "map") {
    return map;
  }
  return std::nullopt;
}

}  // namespace

std::vector<PoseRecord> readPosesIfAny(const std::string& file) {
  std::ifstream stream(file);
  if (!stream) {
    fail(file, "cannot be read");
  }
  std::vector<PoseRecord> records;
  int map = 0;
  std::size_t columns = 0;
  int line_number = 0;
  for (std::string line; std::getline(stream, line);) {
    const std::string where = file + ":" + std::to_string(++line_number);
    const std::size_t hash = line.find('#');
    if (hash != std::string::npos) {
      map = mapOfComment(line.substr(hash + 1)).value_or(map);
      line.resize(hash);
    }
    const std::vector<double> numbers = tellsNoPose(line) ? std::vector<double>() : parseNumbers(line, where);
    if (numbers.empty()) {
      continue;
    }
    if (numbers.size() != kPoseColumns && numbers.size() != kExposureColumns) {
      fail(where, std::to_string(numbers.size()) + " columns; 8 (t, pose) or 16 (t, exposure, start, end) are allowed");
    }
    if (columns != 0 && numbers.size() != columns) {
      fail(where, std::to_string(numbers.size()) + " columns after lines of " + std::to_string(columns));
    }
    columns = numbers.size();
    records.push_back(parseRecord(numbers, where));
    records.back().map = map;
  }
  std::stable_sort(records.begin(), records.end(),
                   [](const PoseRecord& a, const PoseRecord& b) { return a.time < b.time; });
  return records;
}

std::vector<PoseRecord> readPoseFile(const std::string& file) {
  std::vector<PoseRecord> records = readPosesIfAny(file);
  if (records.empty()) {
    fail(file, "contains no pose");
  }
  return records;
}

}  // namespace mba_vo
