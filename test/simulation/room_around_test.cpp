#include <cstdlib>
#include <ostream>

#include <gtest/gtest.h>

#include "mba_vo/simulation/motion_piece.h"
#include "simulation/motion_files.h"
#include "simulation/test_scenes.h"

namespace mba_vo::room_around_test {
namespace {

using test::motionText;
using test::roaming;
using test::TemporaryFile;

/// Smallest distance between the camera and points 4 cm apart on the surfaces [m].
double nearestPoint(const Scene& scene, const MotionPiece& piece) {
  constexpr double kGrid = 0.04;  // [m]
  std::vector<Eigen::Vector3d> cameras;
  for (double t = 0.0; t < piece.span(); t += 0.02) cameras.push_back(piece.pose(t).translation());
  double nearest = 1e9;
  for (const Surface& s : scene.surfaces) {
    const Eigen::Vector3d middle = s.origin + 0.5 * (s.length_u * s.axis_u + s.length_v * s.axis_v);
    const double reach = 0.5 * std::hypot(s.length_u, s.length_v) + 0.6;
    for (const Eigen::Vector3d& camera : cameras) {
      if ((camera - middle).norm() > reach) continue;
      for (double u = 0.0; u <= s.length_u + kGrid; u += kGrid) {
        for (double v = 0.0; v <= s.length_v + kGrid; v += kGrid) {
          const Eigen::Vector3d point =
              s.origin + std::min(u, s.length_u) * s.axis_u + std::min(v, s.length_v) * s.axis_v;
          nearest = std::min(nearest, (point - camera).norm());
        }
      }
    }
  }
  return nearest;
}

void expectGoodViews(const SimulationConfig& config, const std::string& name) {
  const Simulator simulator(config);
  const PoseFunction pose = [&](double t) { return simulator.pose(t); };
  for (int i = 0; i < 10; ++i) {
    const double t = simulator.time((simulator.frames() - 1) * i / 9);
    const cv::Mat1f depth = simulator.renderer().depth(pose, t);
    double nearest, farthest;
    cv::minMaxLoc(depth, &nearest, &farthest);
    EXPECT_GT(nearest, 0.2) << name << " at " << t;  // 0 would be a hole
    const auto total = static_cast<double>(depth.total());
    EXPECT_GT(cv::countNonZero(depth < 8.0F), 0.3 * total) << name << " at " << t;
    cv::Scalar mean, deviation;
    cv::meanStdDev(simulator.renderer().integrate(pose, t, 0.0), mean, deviation);
    EXPECT_GT(deviation[0], 12.0) << name << " at " << t;
    EXPECT_GT(mean[0], 50.0) << name << " at " << t;
    EXPECT_LT(mean[0], 190.0) << name << " at " << t;
  }
}

SimulationConfig along(const std::string& file, int seed) {
  SimulationConfig config = smallConfig();
  config.motion = file;
  config.duration = 0.0;
  config.scene_seed = seed;
  return config;
}

void expectGoodRoom(const std::string& file, int seed) {
  const SimulationConfig config = along(file, seed);
  const MotionPiece piece(config);
  EXPECT_GT(nearestPoint(makeRoomAround(piece.path(), seed), piece), 0.4) << file;
  expectGoodViews(config, file);
}

struct Extent {
  Eigen::Vector3d half_size;
  double path_length;
};

std::ostream& operator<<(std::ostream& out, const Extent& extent) {
  return out << extent.half_size.transpose() << " m, a path of " << extent.path_length << " m";
}

class RoomAround : public testing::TestWithParam<Extent> {};

TEST_P(RoomAround, NothingIsNearAndEveryViewShowsSomething) {
  const double duration = 10.0;
  const TemporaryFile file(motionText(roaming(GetParam().half_size, duration, GetParam().path_length), duration));
  for (const int seed : {1, 6}) expectGoodRoom(file.name(), seed);
}

INSTANTIATE_TEST_SUITE_P(Sizes, RoomAround,
                         testing::Values(Extent{{0.3, 0.2, 0.1}, 0.0}, Extent{{2.0, 2.5, 0.8}, 15.0},
                                         Extent{{9.0, 5.0, 1.5}, 50.0}));

TEST(RoomAround, GrowsWithTheMotionAndStandsInItsMiddle) {
  const auto size = [](const Eigen::Vector3d& half_size, double path_length) {
    const TemporaryFile file(motionText(roaming(half_size, 6.0, path_length), 6.0));
    Eigen::AlignedBox3d box;
    for (const Surface& s : makeRoomAround(MotionPiece(along(file.name(), 1)).path(), 1).surfaces) {
      box.extend(s.origin);
      box.extend(s.origin + s.length_u * s.axis_u + s.length_v * s.axis_v);
    }
    EXPECT_LT(box.center().head<2>().norm(), 0.1);
    EXPECT_NEAR(box.min().z(), 0.0, 1e-3);
    return box.sizes();
  };
  const Eigen::Vector3d small = size({0.3, 0.3, 0.1}, 0.0);
  const Eigen::Vector3d hall = size({9.0, 5.0, 1.5}, 50.0);
  EXPECT_LT(small.x(), 6.5);
  EXPECT_GT(small.x(), 3.5);
  EXPECT_GT(hall.x(), small.x() + 5.0);
  EXPECT_GT(hall.z(), 4.0);
}

/// The recordings in the folder that MBA_VO_MOTIONS names, where there is one.
TEST(RoomAround, SuitsRecordedMotions) {
  const char* folder = std::getenv("MBA_VO_MOTIONS");
  if (folder == nullptr || *folder == '\0') GTEST_SKIP() << "MBA_VO_MOTIONS names no folder of recorded motions";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".txt") expectGoodRoom(entry.path().string(), 1);
  }
}

}  // namespace
}  // namespace mba_vo::room_around_test
