// Says what is in a map that was saved, and writes its points and its keyframes' poses for others to read.
#include <iostream>
#include <limits>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "mba_vo/io/map_file.h"
#include "mba_vo/io/points_file.h"
#include "mba_vo/io/trajectory_writer.h"

namespace {

struct Arguments {
  std::string map;
  std::string points;
  std::string trajectory;
};

void describe(CLI::App& app, Arguments& a) {
  app.add_option("MAP", a.map, "file that --save-map or the service save_map wrote")->required();
  app.add_option("--points", a.points, "PLY file for its points");
  app.add_option("--trajectory", a.trajectory,
                 "file for the keyframes' poses, by the stamps of their images (TUM form)");
}

void print(const mba_vo::SavedMap& map, std::ostream& out) {
  const mba_vo::ArchivedKeyframe& first = map.keyframes.front();
  Eigen::AlignedBox3d box;
  for (const auto& keyframe : map.keyframes) box.extend(keyframe.reference.T_map_reference.translation());
  const char* unit = map.metric ? " m" : " of an arbitrary unit";
  out << "keyframes: " << map.keyframes.size() << "\n"
      << "points: " << map.pointCount() << ", as often as keyframes see them\n"
      << "images: " << first.camera.width << "x" << first.camera.height << ", focal length " << first.camera.fx << ", "
      << first.camera.fy << " px\n"
      << "camera positions: from " << box.min().transpose() << " to " << box.max().transpose() << unit << "\n"
      << "usual error of frames: " << map.usual_error << " px\n";
}

std::vector<mba_vo::TrajectoryEntry> posesOf(const mba_vo::SavedMap& map) {
  std::vector<mba_vo::TrajectoryEntry> poses;
  for (const mba_vo::ArchivedKeyframe& keyframe : map.keyframes) {
    mba_vo::TrajectoryEntry entry;
    entry.frame_sequence = keyframe.frame_sequence;
    entry.stamp_ns = entry.mid_exposure_ns = keyframe.stamp_ns;
    entry.trajectory.T_reference_mid = keyframe.reference.T_map_reference;
    poses.push_back(entry);
  }
  return poses;
}

void run(const Arguments& a) {
  const mba_vo::SavedMap map = mba_vo::readMap(a.map);
  print(map, std::cout);
  if (!a.points.empty()) {
    const auto points = mba_vo::displayPoints(map, 0, std::numeric_limits<std::size_t>::max());
    mba_vo::writeFile(a.points, [&](std::ostream& out) { mba_vo::writePointsPly(points, out); });
  }
  if (!a.trajectory.empty()) {
    mba_vo::writeFile(a.trajectory, [&](std::ostream& out) { mba_vo::writeTrajectory(posesOf(map), out); });
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Says what is in a map that was saved, and exports it.", "mba_vo_map");
  Arguments arguments;
  describe(app, arguments);
  CLI11_PARSE(app, argc, argv);
  try {
    run(arguments);
  } catch (const std::exception& error) {
    std::cerr << "mba_vo_map: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
