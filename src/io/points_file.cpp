#include "mba_vo/io/points_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "mba_vo/io/trajectory_writer.h"

namespace mba_vo {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;

[[noreturn]] void fail(const std::string& file, std::size_t line, const std::string& text) {
  throw std::runtime_error(file + ":" + std::to_string(line) + ": '" + text + "' is no point (t_keyframe x y z)");
}

}  // namespace

void writePoints(const std::vector<MapPoint>& points, std::ostream& out) {
  constexpr int kDigits = 9;
  out << "# t_keyframe x y z\n" << std::setprecision(kDigits);
  std::optional<MapId> map;
  for (const MapPoint& point : points) {
    if (map != point.map_id) out << "# map " << point.map_id << "\n";
    map = point.map_id;
    const Eigen::Vector3d& p = point.position_map;
    out << formatSeconds(point.keyframe_ns) << ' ' << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
  }
}

void writePointsPly(const std::vector<MapPoint>& points, std::ostream& out) {
  constexpr int kDigits = 9;
  out << "ply\nformat ascii 1.0\ncomment mba_vo: camera axes (z forward, x right, y down) of the map's first keyframe\n"
      << "element vertex " << points.size() << "\nproperty float x\nproperty float y\nproperty float z\n"
      << "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uint keyframe\nend_header\n"
      << std::setprecision(kDigits);
  for (const MapPoint& point : points) {
    const Eigen::Vector3d& p = point.position_map;
    const int grey = static_cast<int>(std::lround(std::clamp(point.intensity, 0.0F, 255.0F)));
    out << p.x() << ' ' << p.y() << ' ' << p.z() << ' ' << grey << ' ' << grey << ' ' << grey << ' '
        << point.keyframe_id << '\n';
  }
}

std::vector<MapPoint> readPoints(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file + ": cannot be read");
  std::vector<MapPoint> points;
  MapPoint point;
  std::string text;
  for (std::size_t line = 1; std::getline(in, text); ++line) {
    std::istringstream words(text);
    std::string word;
    if (!(words >> word)) continue;
    if (word[0] == '#') {
      if (words >> word && word == "map" && !(words >> point.map_id)) fail(file, line, text);
      continue;
    }
    std::istringstream numbers(text);
    double seconds = 0.0;
    Eigen::Vector3d& p = point.position_map;
    if (!(numbers >> seconds >> p.x() >> p.y() >> p.z()) || numbers >> word) fail(file, line, text);
    point.keyframe_ns = std::llround(seconds * kNanosecondsPerSecond);
    points.push_back(point);
  }
  return points;
}

}  // namespace mba_vo
