#include "mba_vo/evaluation/pose_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/temporary_folder.h"
#include "mba_vo/evaluation/frame_log.h"

namespace mba_vo::pose_file_test {
namespace {

using testing::HasSubstr;

std::string errorFor(const std::string& text) {
  const TemporaryFolder folder;
  const std::string file = folder.write("poses.txt", text);
  return messageOf([&] { readPoseFile(file); });
}

TEST(PoseFile, ReadsTumFormSortedByTime) {
  const TemporaryFolder folder;
  const auto poses =
      readPoseFile(folder.write("p.txt", "# comment\n2.5 1 2 3 0 0 0.6 0.8\n\n1.5 4 5 6 0 0 0 1 # end\n"));
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_DOUBLE_EQ(poses[0].time, 1.5);
  EXPECT_EQ(poses[0].T_world_camera.translation(), Eigen::Vector3d(4, 5, 6));
  EXPECT_DOUBLE_EQ(poses[1].T_world_camera.rotation().z(), 0.6);
  EXPECT_DOUBLE_EQ(poses[1].T_world_camera.rotation().w(), 0.8);
  EXPECT_FALSE(poses[0].exposure.has_value());
}

TEST(PoseFile, ReadsExposuresAndPutsTheMidPoseHalfWay) {
  const TemporaryFolder folder;
  // 90 deg about z within the exposure, so 45 deg at its middle.
  const auto poses =
      readPoseFile(folder.write("p.txt", "1 0.02 0 0 0 0 0 0 1 0 0 0 0 0 0.70710678118 0.70710678118\n"));
  ASSERT_EQ(poses.size(), 1U);
  ASSERT_TRUE(poses[0].exposure.has_value());
  EXPECT_DOUBLE_EQ(poses[0].exposure->exposure, 0.02);
  EXPECT_NEAR(poses[0].T_world_camera.rotation().z(), std::sin(M_PI / 8.0), 1e-9);
}

TEST(PoseFile, CommentsAssignPosesToMaps) {
  const TemporaryFolder folder;
  const auto poses = readPoseFile(folder.write(
      "p.txt",
      "1 0 0 0 0 0 0 1\n# map 3\n2 0 0 0 0 0 0 1\n# mapping is fun\n3 0 0 0 0 0 0 1\n# map 4\n4 0 0 0 0 0 0 1\n"));
  ASSERT_EQ(poses.size(), 4U);
  EXPECT_EQ(poses[0].map, 0);
  EXPECT_EQ(poses[1].map, 3);
  EXPECT_EQ(poses[2].map, 3);
  EXPECT_EQ(poses[3].map, 4);
}

TEST(PoseFile, BadInputIsNamedWithItsLine) {
  EXPECT_THAT(messageOf([] { readPoseFile("/nonexistent/poses.txt"); }),
              HasSubstr("/nonexistent/poses.txt: cannot be"));
  EXPECT_THAT(errorFor("# nothing\n"), HasSubstr("contains no pose"));
  EXPECT_THAT(errorFor("1 0 0 0 0 0 0 1\n2 0 0 0 0 0 1\n"), HasSubstr("poses.txt:2: 7 columns"));
  EXPECT_THAT(errorFor("1 0 0 x 0 0 0 1\n"), HasSubstr("poses.txt:1: 'x'"));
  EXPECT_THAT(errorFor("1 0 0 nan 0 0 0 1\n"), HasSubstr("'nan'"));
  EXPECT_THAT(errorFor("1 0 0 0 0 0 0 0\n"), HasSubstr("quaternion"));
  EXPECT_THAT(errorFor("1 -0.02 0 0 0 0 0 0 1 0 0 0 0 0 0 1\n"), HasSubstr("negative"));
  EXPECT_THAT(errorFor("1 0 0 0 0 0 0 1\n1 0.02 0 0 0 0 0 0 1 0 0 0 0 0 0 1\n"),
              HasSubstr("16 columns after lines of 8"));
}

TEST(FrameLog, ReadsNamedColumnsInAnyOrder) {
  const TemporaryFolder folder;
  const auto frames =
      readFrameLog(folder.write("f.csv", "status,reason,time\nLOST,\"no, \"\"really\"\"\",1.5\nTRACKING,,2.5\n"));
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0].status, "LOST");
  EXPECT_DOUBLE_EQ(frames[0].time, 1.5);
  EXPECT_DOUBLE_EQ(frames[1].time, 2.5);
  EXPECT_EQ(splitCsvLine("a,\"b, \"\"c\"\"\",")[1], "b, \"c\"");
}

TEST(FrameLog, BadInputIsNamed) {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& text) {
    const std::string file = folder.write("f.csv", text);
    return messageOf([&] { readFrameLog(file); });
  };
  EXPECT_THAT(messageOf([] { readFrameLog("/nonexistent.csv"); }), HasSubstr("/nonexistent.csv: cannot be read"));
  EXPECT_THAT(error("time,reason\n"), HasSubstr("no column named 'status'"));
  EXPECT_THAT(error("time,status\n1.0\n"), HasSubstr("f.csv:2: 1 fields"));
  EXPECT_THAT(error("time,status\nsoon,LOST\n"), HasSubstr("time 'soon'"));
}

}  // namespace
}  // namespace mba_vo::pose_file_test
