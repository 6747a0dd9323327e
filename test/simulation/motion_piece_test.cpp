#include "mba_vo/simulation/motion_piece.h"

#include <cmath>

#include <gtest/gtest.h>

#include "simulation/motion_files.h"
#include "simulation/test_scenes.h"

namespace mba_vo::motion_piece_test {
namespace {

using test::motionText;
using test::roaming;
using test::TemporaryFile;

/// 6 s through a space of 4 x 2 m.
const std::string& recording() {
  static const std::string text = motionText(roaming({2.0, 1.0, 0.2}, 6.0, 0.0), 6.0);
  return text;
}

SimulationConfig along(const TemporaryFile& file, double start, double duration) {
  SimulationConfig config = smallConfig();
  config.motion = file.name();
  config.start = start;
  config.duration = duration;
  config.rate = 20.0;
  return config;
}

std::string messageOf(const SimulationConfig& config) {
  try {
    const MotionPiece piece(config);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(MotionPiece, IsTheRecordingMovedOverAFloor) {
  const TemporaryFile file(recording());
  const MotionPiece piece(along(file, 2.0, 3.0));
  const PoseFunction truth = roaming({2.0, 1.0, 0.2}, 6.0, 0.0);
  const Eigen::Vector3d shift = piece.pose(0.0).translation() - truth(2.01).translation();
  EXPECT_GT(shift.norm(), 5.0);
  Eigen::AlignedBox3d box;
  for (double t = 0.0; t < 2.98; t += 0.013) {
    // The first exposure of 20 ms begins with the piece.
    EXPECT_LT((piece.pose(t).translation() - truth(2.01 + t).translation() - shift).norm(), 1e-4) << t;
    EXPECT_LT(piece.pose(t).rotation().angularDistance(truth(2.01 + t).rotation()), 1e-4) << t;
    box.extend(piece.pose(t).translation());
  }
  EXPECT_LT(box.center().head<2>().norm(), 0.1);
  EXPECT_NEAR(box.min().z(), 0.9, 0.05);  // the recorded heights about 0.2 m are lifted
}

TEST(MotionPiece, KeepsAHeightThatMayBeOne) {
  const auto lifted = [](double t) {
    const SE3 pose = roaming({2.0, 1.0, 0.2}, 2.0, 0.0)(t);
    return SE3(pose.rotation(), pose.translation() + Eigen::Vector3d(0.0, 0.0, 1.2));
  };
  const TemporaryFile file(motionText(lifted, 2.0));
  const MotionPiece piece(along(file, 0.0, 0.0));
  EXPECT_NEAR(piece.pose(0.5).translation().z(), lifted(0.51).translation().z(), 1e-4);
}

TEST(MotionPiece, AllExposuresLieWithinThePiece) {
  const TemporaryFile file(recording());
  SimulationConfig config = along(file, 0.0, 0.0);  // all of it
  config.row_time = 1e-4;
  const Simulator simulator(config, sharedRoom());
  const double margin = 0.01 + 0.5 * 119 * 1e-4;
  EXPECT_EQ(simulator.frames(), static_cast<int>(std::floor((6.0 - 2.0 * margin) * 20.0)) + 1);
  const PoseFunction truth = roaming({2.0, 1.0, 0.2}, 6.0, 0.0);
  const auto moved = [](const SE3& a, const SE3& b) { return (a.translation() - b.translation()).norm(); };
  // Beyond its ends the recording would stand still.
  EXPECT_NEAR(moved(simulator.pose(-margin), simulator.pose(0.0)), moved(truth(0.0), truth(margin)), 1e-4);
  EXPECT_GT(moved(truth(0.0), truth(margin)), 1e-3);
  EXPECT_EQ(moved(simulator.pose(-margin), simulator.pose(-margin - 1.0)), 0.0);
}

TEST(MotionPiece, BeyondTheFileIsAnErrorThatNamesBoth) {
  const TemporaryFile file(recording());
  EXPECT_EQ(messageOf(along(file, 2.0, 3.9)), "accepted");
  EXPECT_EQ(messageOf(along(file, 2.0, 4.5)),
            "start = 2 s with duration = 4.5 s reaches beyond the 6 s of '" + file.name() + "'");
  EXPECT_EQ(messageOf(along(file, 8.0, 0.0)), "start = 8 s reaches beyond the 6 s of '" + file.name() + "'");
  EXPECT_NE(messageOf(along(file, 1.0, 0.01)).find("shorter than one exposure of 0.02"), std::string::npos);
}

TEST(MotionPiece, FingerprintFollowsThePosesNotTheName) {
  const TemporaryFile file(recording());
  const TemporaryFile copy(recording());
  const std::string base = along(file, 2.0, 3.0).fingerprint();
  EXPECT_EQ(along(copy, 2.0, 3.0).fingerprint(), base);
  EXPECT_NE(along(copy, 2.1, 3.0).fingerprint(), base);
  std::string other = recording();
  const std::size_t line = other.find("\n3.5000 ") + 10;  // a digit of x
  other[line + 4] = other[line + 4] == '5' ? '6' : '5';
  const TemporaryFile changed(other);
  EXPECT_NE(along(changed, 2.0, 3.0).fingerprint(), base);
  EXPECT_EQ(base.find(file.name()), std::string::npos);
  EXPECT_NE(base.find("\nmotion="), std::string::npos);
}

TEST(MotionPiece, PathHasNoGaps) {
  const TemporaryFile file(recording());
  const MotionPiece piece(along(file, 0.0, 0.0));
  const std::vector<Eigen::Vector3d> path = piece.path();
  for (std::size_t i = 1; i < path.size(); ++i) EXPECT_LT((path[i] - path[i - 1]).norm(), 0.025);
  for (double t = 0.0; t < piece.span(); t += 0.0107) {
    double nearest = 1.0;
    for (const Eigen::Vector3d& p : path) nearest = std::min(nearest, (p - piece.pose(t).translation()).norm());
    EXPECT_LT(nearest, 0.0125) << t;
  }
}

}  // namespace
}  // namespace mba_vo::motion_piece_test
