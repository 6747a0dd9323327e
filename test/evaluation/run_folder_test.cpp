#include "mba_vo/evaluation/run_folder.h"

#include <filesystem>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluation/synthetic_run.h"

namespace mba_vo::run_folder_test {
namespace {

using testing::HasSubstr;

std::vector<PoseRecord> twoPoses() { return {{1.0, SE3(), std::nullopt, 1}, {2.0, SE3(), std::nullopt, 1}}; }

std::vector<FrameRow> twoRows() { return {publishedRow(1.0, 0.02, "TRACKING"), publishedRow(2.0, 0.03, "DEGRADED")}; }

RunFolder read(const TemporaryFolder& folder) { return readRunFolder(folder.file("run"), PoseForm::kPoses); }

TEST(RunFolder, ReadsAllThatARunWrites) {
  const TemporaryFolder folder;
  Matrix6 P;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      P(i, j) = 1.0 + std::min(i, j) + 0.01 * std::max(i, j);
    }
  }
  std::vector<FrameRow> rows = twoRows();
  rows[1].covariance = covarianceText(P);
  rows.push_back(silentRow(3.0, "LOST"));
  writeRunFolder(folder, twoPoses(), twoPoses(), rows, "frames: 3\nrestarts: 2\nmetric_maps: 1\n");
  const RunFolder run = read(folder);
  EXPECT_EQ(run.online_trajectory.size(), 2U);
  EXPECT_EQ(run.online_odometry[0].map, 1);
  EXPECT_EQ(run.smoothed.size(), 2U);
  ASSERT_EQ(run.online_frames.size(), 3U);
  EXPECT_NEAR(run.online_frames[0].latency(), 0.02, 1e-9);
  EXPECT_FALSE(run.online_frames[0].covariance.has_value());
  EXPECT_LT((*run.online_frames[1].covariance - P).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(run.online_frames[1].status, OnlineStatus::kDegraded);
  EXPECT_FALSE(run.online_frames[2].published.has_value());
  EXPECT_EQ(run.frames.size(), 3U);
  EXPECT_EQ(run.restarts, 2);
  EXPECT_TRUE(run.metric);
}

TEST(RunFolder, ManagesWithoutPosesSmoothedTrajectoryAndSummary) {
  const TemporaryFolder folder;
  writeRunFolder(folder, {}, {}, twoRows(), "");
  std::filesystem::remove(folder.file("run/trajectory.txt"));
  std::filesystem::remove(folder.file("run/summary.yaml"));
  const RunFolder run = read(folder);
  EXPECT_TRUE(run.online_odometry.empty());
  EXPECT_TRUE(run.smoothed.empty());
  EXPECT_EQ(run.restarts, 0);
  EXPECT_FALSE(run.metric);
}

TEST(RunFolder, TakesTheMotionWithinTheExposureWhereAsked) {
  const TemporaryFolder folder;
  writeRunFolder(folder, twoPoses(), {}, twoRows(), "");
  folder.write("run/exposure_trajectory.txt", "1 0.02 0 0 0 0 0 0 1 0 0 0 0 0 0 1\n");
  EXPECT_TRUE(read(folder).smoothed.empty());
  EXPECT_TRUE(readRunFolder(folder.file("run"), PoseForm::kExposures).smoothed.at(0).exposure.has_value());
}

TEST(RunFolder, StartAndEndAsPublishedGoWithTheirPoses) {
  const TemporaryFolder folder;
  writeRunFolder(folder, twoPoses(), {}, twoRows(), "");
  const std::string line = " 0.02 0 0 0 0 0 0 1 0.5 0 0 0 0 0 1\n";
  folder.write("run/online_exposure_trajectory.txt", "1" + line + "2" + line);
  EXPECT_FALSE(read(folder).online_trajectory.at(0).exposure.has_value()) << "nobody asked";
  const auto poses = readRunFolder(folder.file("run"), PoseForm::kExposures).online_trajectory;
  ASSERT_TRUE(poses.at(1).exposure.has_value());
  EXPECT_EQ(poses.at(1).exposure->T_world_end.translation().x(), 0.5);
  EXPECT_EQ(poses.at(1).T_world_camera.translation(), twoPoses().at(1).T_world_camera.translation());
  folder.write("run/online_exposure_trajectory.txt", "1" + line);
  EXPECT_THAT(messageOf([&] { readRunFolder(folder.file("run"), PoseForm::kExposures); }),
              HasSubstr("online_exposure_trajectory.txt: 1 poses, and 2 in online_trajectory.txt"));
}

TEST(RunFolder, MissingFilesAreNamed) {
  EXPECT_THAT(messageOf([] { readRunFolder("/nonexistent", PoseForm::kPoses); }), HasSubstr("/nonexistent: no such"));
  for (const char* file : {"online_trajectory.txt", "online_odometry.txt", "frames.csv"}) {
    const TemporaryFolder folder;
    writeRunFolder(folder, twoPoses(), twoPoses(), twoRows(), "");
    std::filesystem::remove(folder.file(std::string("run/") + file));
    EXPECT_THAT(messageOf([&] { read(folder); }), HasSubstr(file));
  }
}

TEST(RunFolder, MalformedFilesAreNamedWithTheirLine) {
  const auto message = [](const std::string& file, const std::string& text) {
    const TemporaryFolder folder;
    writeRunFolder(folder, twoPoses(), twoPoses(), twoRows(), "");
    folder.write("run/" + file, text);
    return messageOf([&] { read(folder); });
  };
  EXPECT_THAT(message("online_odometry.txt", "1 0 0 0 0 0 0 1\n2 0 x 0 0 0 0 1\n"),
              HasSubstr("online_odometry.txt:2: 'x'"));
  EXPECT_THAT(message("summary.yaml", "frames: 3\nrestarts: many\n"), HasSubstr("summary.yaml:2: restarts 'many'"));
  EXPECT_THAT(message("frames.csv", "time,status\n1,LOST\n"), HasSubstr("frames.csv:1: no column named 'arrival'"));
  EXPECT_THAT(message("frames.csv", framesText({})), HasSubstr("frames.csv: lists no image"));
  const auto with = [&](const std::function<void(FrameRow&)>& change) {
    std::vector<FrameRow> rows = twoRows();
    change(rows[1]);
    return message("frames.csv", framesText(rows));
  };
  EXPECT_THAT(with([](FrameRow& r) { r.arrival = "soon"; }), HasSubstr("frames.csv:3: arrival 'soon'"));
  EXPECT_THAT(with([](FrameRow& r) { r.arrival.clear(); }), HasSubstr("frames.csv:3: published, but without arrival"));
  EXPECT_THAT(with([](FrameRow& r) { r.published = "1"; }), HasSubstr("frames.csv:3: published 1001.000000 s before"));
  EXPECT_THAT(with([](FrameRow& r) { r.online_status = "FINE"; }),
              HasSubstr("online_status 'FINE' is none of TRACKING"));
  EXPECT_THAT(with([](FrameRow& r) { r.covariance = "1 2 3"; }), HasSubstr("frames.csv:3: covariance has 3 numbers"));
  EXPECT_THAT(with([](FrameRow& r) { r.covariance = "1 nan"; }), HasSubstr("covariance has 'nan'"));
}

}  // namespace
}  // namespace mba_vo::run_folder_test
