#include "mba_vo/datasets/ground_truth.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/miniature.h"

namespace mba_vo::ground_truth_test {
namespace {

using testing::HasSubstr;

void expectPose(const PoseRecord& pose, double time, const Eigen::Vector3d& position, const Eigen::Matrix3d& rotation) {
  EXPECT_NEAR(pose.time, time, 1e-6);
  EXPECT_TRUE(pose.T_world_camera.translation().isApprox(position, 1e-9))
      << pose.T_world_camera.translation().transpose();
  EXPECT_TRUE(pose.T_world_camera.rotationMatrix().isApprox(rotation, 1e-9)) << pose.T_world_camera.rotationMatrix();
}

Eigen::Matrix3d rows(const std::vector<double>& v) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(v.data());
}

TEST(GroundTruth, OfTumRgbdAndEth3dIsThatOfTheCamera) {
  const TemporaryFolder folder;
  writeTumRgbd(folder, "fr1");
  writeEth3d(folder, "e");
  for (const char* path : {"fr1", "fr1/groundtruth.txt"}) {
    const auto poses = readGroundTruth(folder.file(path));
    ASSERT_EQ(poses.size(), 2U);
    EXPECT_NEAR(poses[0].time, 1305031225.9334, 1e-6);
    EXPECT_TRUE(poses[0].T_world_camera.translation().isApprox(Eigen::Vector3d(1.3357, 0.6698, 1.6180)));
    EXPECT_NEAR(poses[0].T_world_camera.rotation().w(), -0.3496, 1e-4);
  }
  // By 2 acos(0.8) about z.
  expectPose(readGroundTruth(folder.file("e")).at(0), 5455.183914, {0.1, 0.2, 0.3},
             rows({0.28, -0.96, 0, 0.96, 0.28, 0, 0, 0, 1}));
}

TEST(GroundTruth, OfEurocIsMovedFromTheBodyIntoTheCamera) {
  const TemporaryFolder folder;
  writeEuroc(folder, "V1");
  for (const char* path : {"V1", "V1/mav0/state_groundtruth_estimate0/data.csv"}) {
    const auto poses = readGroundTruth(folder.file(path));
    ASSERT_EQ(poses.size(), 2U);
    // The body's x, y, z axes are the world's y, z, x; the camera is at (-0.02, -0.06, 0.01) in the body, its x axis
    // is the body's y and its y axis the body's -x.
    expectPose(poses[0], 1403715273.262142976, {4.01, 4.98, 5.94}, rows({0, 0, 1, 0, -1, 0, 1, 0, 0}));
    expectPose(poses[1], 1403715273.267142976, {4.48, 5.44, 6.51}, rows({0, -1, 0, 1, 0, 0, 0, 0, 1}));
  }
}

TEST(GroundTruth, OfASensorOnTheBodyIsMovedByItsOwnPlace) {
  const TemporaryFolder folder;
  writeEuroc(folder, "V1");
  folder.write("V1/mav0/vicon0/sensor.yaml",
               "sensor_type: pose\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1, 0, 0, 0.1, 0, 1, 0, 0.2, 0, 0, 1, 0.3, 0, "
               "0, 0, 1]\n");
  folder.write("V1/mav0/vicon0/data.csv",
               "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n"
               "1403715273262142976,1,2,3,1,0,0,0\n");
  expectPose(readGroundTruth(folder.file("V1/mav0/vicon0/data.csv")).at(0), 1403715273.262142976,
             {1.0 - 0.1 - 0.02, 2.0 - 0.2 - 0.06, 3.0 - 0.3 + 0.01}, rows({0, -1, 0, 1, 0, 0, 0, 0, 1}));
}

TEST(GroundTruth, OfTumViIsMovedByWhatKalibrFound) {
  const TemporaryFolder folder;
  writeTumVi(folder, "room");
  // T_cam_imu: x_cam = x + 0.1, y_cam = -z + 0.2, z_cam = y + 0.3. So the camera's origin is at (-0.1, -0.3, 0.2).
  expectPose(readGroundTruth(folder.file("room")).at(0), 1520530308.199447626, {0.9, 1.7, 3.2},
             rows({1, 0, 0, 0, 0, 1, 0, -1, 0}));
}

TEST(GroundTruth, OfTumMonoIsKnownAtBothEndsOnly) {
  const TemporaryFolder folder;
  writeTumMono(folder, "m");
  const auto poses = readGroundTruth(folder.file("m"));
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_NEAR(poses[1].time, 1464106180.580027, 1e-6);
}

TEST(GroundTruth, OfSevenScenesIsInAFileForEachImage) {
  const TemporaryFolder folder;
  writeSevenScenes(folder, "seq-01");
  const auto poses = readGroundTruth(folder.file("seq-01"));
  ASSERT_EQ(poses.size(), 3U);
  expectPose(poses[2], 0.1, {0.1, 0.2, 0.3}, rows({0, -1, 0, 1, 0, 0, 0, 0, 1}));
}

TEST(GroundTruth, WhatIsWrongIsNamedWithItsLine) {
  const TemporaryFolder folder;
  writeEuroc(folder, "V1");
  const std::string truth = "V1/mav0/state_groundtruth_estimate0/data.csv";
  const std::string head =
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n";
  const auto error = [&](const std::string& text) {
    folder.write(truth, text);
    return messageOf([&] { readGroundTruth(folder.file(truth)); });
  };
  EXPECT_THAT(error(head + "1403715273262142976,4,5,6,1,0,0\n"), HasSubstr("data.csv:2: 7 fields"));
  EXPECT_THAT(error(head + "1403715273262142976,4,5,x,1,0,0,0\n"), HasSubstr("data.csv:2: value 'x'"));
  EXPECT_THAT(error(head + "1403715273262142976,4,5,6,2,0,0,0\n"), HasSubstr("data.csv:2: quaternion has norm 2"));
  EXPECT_THAT(error(head + "soon,4,5,6,1,0,0,0\n"), HasSubstr("data.csv:2: time [ns] 'soon'"));
  EXPECT_THAT(error(head), HasSubstr("data.csv: contains no pose"));
  EXPECT_THAT(error("#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m]\n1,2,3,4\n"),
              HasSubstr("data.csv:1: no column 'q_RS_w'"));
  folder.write("V1/mav0/cam0/sensor.yaml", "resolution: [752, 480]\nintrinsics: [458, 457, 367, 248]\n");
  EXPECT_THAT(error(head + "1403715273262142976,4,5,6,1,0,0,0\n"), HasSubstr("sensor.yaml: does not tell where"));
  GroundTruthOptions options;
  options.calibration_file = folder.write(
      "mine.yaml",
      "resolution: [752, 480]\nintrinsics: [458, 457, 367, 248]\nT_BS: {data: [1,0,0,1, 0,1,0,1, 0,0,1,1, 0,0,0,1]}\n");
  EXPECT_EQ(readGroundTruth(folder.file(truth), options).at(0).T_world_camera.translation(), Eigen::Vector3d(5, 6, 7));
}

TEST(GroundTruth, SpoiltPosesOfSevenScenesAreNamed) {
  const TemporaryFolder folder;
  writeSevenScenes(folder, "s");
  const auto error = [&](const std::string& text) {
    folder.write("s/frame-000001.pose.txt", text);
    return messageOf([&] { readGroundTruth(folder.file("s")); });
  };
  EXPECT_THAT(error("1 0 0 0\n0 1 0 0\n"), HasSubstr("frame-000001.pose.txt: 8 values, must be 16"));
  EXPECT_THAT(error("1 0 0 0\n0 1 0 y\n"), HasSubstr("frame-000001.pose.txt:2: value 'y'"));
  EXPECT_THAT(error("1 0 0 0\n0 1 0 inf\n"), HasSubstr("frame-000001.pose.txt:2: value 'inf' is not finite"));
  EXPECT_THAT(error("2 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"), HasSubstr("the pose must be a rotation"));
  EXPECT_THAT(error(""), HasSubstr("frame-000001.pose.txt: is empty"));
  folder.write("none/readme.md", "");
  EXPECT_THAT(messageOf([&] { readGroundTruth(folder.file("none")); }), HasSubstr("none: no ground truth, none of"));
}

}  // namespace
}  // namespace mba_vo::ground_truth_test
