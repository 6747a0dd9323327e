#include "mba_vo/evaluation/causal_report.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluation/synthetic_run.h"
#include "mba_vo/evaluation/run_report_writer.h"

namespace mba_vo::causal_report_test {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr double kDepth = 2.5;  // metres per unit of the map
constexpr int kImages = 200;    // in 10 s
constexpr int kFirst = 30;      // image with a pose

/// Still for 1 s, then 0.5 m/s along x with a bend in y and z: 5 cm, 2 % of the depth, are reached at 1.1 s.
std::vector<PoseRecord> trueMotion() {
  std::vector<PoseRecord> poses;
  for (int i = 0; i < kImages; ++i) {
    const double t = std::max(0.0, 0.05 * i - 1.0);
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.2 * t, Eigen::Vector3d::UnitY()));
    poses.push_back({0.05 * i, SE3(turn, {0.5 * t, 0.2 * t * t, 0.3 * std::sin(t)}), std::nullopt, 0});
  }
  return poses;
}

std::vector<PoseRecord> fromFirst(std::vector<PoseRecord> poses) {
  poses.erase(poses.begin(), poses.begin() + kFirst);
  return poses;
}

std::vector<FrameRow> usualRows() {
  std::vector<FrameRow> rows;
  for (int i = 0; i < kImages; ++i) {
    rows.push_back(i < kFirst ? silentRow(0.05 * i, "INITIALIZING") : publishedRow(0.05 * i, 0.01, "TRACKING"));
    rows.back().covariance = i < kFirst ? "" : covarianceText(1e-4 * Matrix6::Identity());
  }
  return rows;
}

RunReport evaluate(const TemporaryFolder& folder, const RunOptions& options = {}) {
  return evaluateRun(trueMotion(), readRunFolder(folder.file("run"), PoseForm::kPoses), options);
}

std::string tableOf(const RunReport& report) {
  std::ostringstream out;
  writeRunTable(report, out);
  return out.str();
}

std::string yamlOf(const RunReport& report) {
  std::ostringstream out;
  writeRunYaml(report, out);
  return out.str();
}

TEST(CausalReport, JudgesWhatWasPublishedAndBesideItTheSmoothedTrajectory) {
  const TemporaryFolder folder;
  const std::vector<PoseRecord> exact = inOtherCoordinates(fromFirst(trueMotion()), kDepth);
  std::vector<PoseRecord> online = exact;
  for (std::size_t i = 0; i < online.size(); ++i) {  // 4 cm up and down
    const SE3& T = online[i].T_world_camera;
    online[i].T_world_camera =
        SE3(T.rotation(), T.translation() + Eigen::Vector3d(0, 0, (i % 2 == 0 ? 0.04 : -0.04) / kDepth));
  }
  writeRunFolder(folder, online, exact, usualRows(), "");
  const RunReport report = evaluate(folder);
  EXPECT_NEAR(report.trajectory.report->absolute.rmse, 0.04, 1e-3);
  EXPECT_NEAR(report.odometry.report->absolute.rmse, 0.04, 1e-3);
  EXPECT_LT(report.smoothed.report->absolute.max, 1e-9);
  EXPECT_NEAR(report.depth.metres, kDepth, 0.01);
  EXPECT_EQ(report.depth.source, SceneDepth::Source::kOnline);
  EXPECT_NEAR(report.parallax_time.value(), 1.1, 1e-9);
  EXPECT_NEAR(report.availability.first_pose_after_start.value(), 1.51, 1e-6);
  EXPECT_NEAR(report.availability.first_pose_after_parallax.value(), 0.41, 1e-6);
  EXPECT_EQ(report.availability.pose_in_time.count, 170U);
  EXPECT_EQ(report.availability.pose_in_time_moving.of, 171U);  // images after 1.4 s
  EXPECT_EQ(report.logged_without_pose, 0U);
  const std::string table = tableOf(report);
  EXPECT_LT(table.find("causal: as published"), table.find("smoothed: "));
  EXPECT_THAT(table, HasSubstr("170 of 200 (85.0 %)"));
  EXPECT_THAT(table, HasSubstr("scale of the published poses"));
  EXPECT_THAT(table, Not(HasSubstr("restart")));
}

TEST(CausalReport, YamlHasStableKeys) {
  const TemporaryFolder folder;
  const std::vector<PoseRecord> poses = inOtherCoordinates(fromFirst(trueMotion()), kDepth);
  writeRunFolder(folder, poses, poses, usualRows(), "restarts: 2\n");
  RunOptions options;
  options.nees_times = {0.5, 1.0, 60.0};
  const std::string yaml = yamlOf(evaluate(folder, options));
  for (const char* text :
       {"causal:\n  restarts: 2\n  alignment: sim3\n  map:\n    scale: 2.", "  odometry:\n    scale: 2.",
        "    ate: {rmse: ", "  availability:\n    frame_interval: 0.0", "depth_source: online",
        "    pose_in_time: {count: 170, of: 200, percent: 85}\n",
        "    latency_ms: {median: ", "      INITIALIZING: 30\n", "  consistency:\n    map: 0\n    first_map: true\n",
        "    nees_0.5: {total: ", "    nees_1: {total: ", "    nees_60: {total: .nan",
        "smoothed:\n  restarts: 2\n  alignment: sim3\n", "  ate: {rmse: "}) {
    EXPECT_THAT(yaml, HasSubstr(text));
  }
  EXPECT_THAT(yaml, Not(HasSubstr("\nate:")));
}

TEST(CausalReport, RestartsStandBesideEveryBlock) {
  const TemporaryFolder folder;
  const std::vector<PoseRecord> poses = inOtherCoordinates(fromFirst(trueMotion()), kDepth);
  writeRunFolder(folder, poses, poses, usualRows(), "restarts: 2\n");
  const std::string table = tableOf(evaluate(folder));
  std::size_t count = 0;
  const std::string note = "(after 2 restarts with what was learnt: not causal in one pass)";
  for (std::size_t at = table.find(note); at != std::string::npos; at = table.find(note, at + 1)) {
    ++count;
  }
  EXPECT_EQ(count, 4U);
}

TEST(CausalReport, OnlyTheLargestMapIsEvaluated) {
  const TemporaryFolder folder;
  std::vector<PoseRecord> poses = inOtherCoordinates(fromFirst(trueMotion()), kDepth);
  for (std::size_t i = 0; i < 50; ++i) {
    poses[i].map = 1;
    poses[i].T_world_camera = SE3(Eigen::Quaterniond::Identity(), {0.1 * static_cast<double>(i), 5, 5});
  }
  for (std::size_t i = 50; i < poses.size(); ++i) {
    poses[i].map = 2;
  }
  writeRunFolder(folder, poses, poses, usualRows(), "");
  const RunReport report = evaluate(folder);
  EXPECT_EQ(report.trajectory.report->map, 2);
  EXPECT_EQ(report.odometry.report->poses_in_other_maps, 50U);
  EXPECT_LT(report.trajectory.report->absolute.max, 1e-9);
  EXPECT_LT(report.odometry.report->absolute.max, 1e-9);
  EXPECT_THAT(tableOf(report), HasSubstr("2 maps, the largest, 2, is evaluated, 50 poses are in the others"));
  EXPECT_THAT(tableOf(report), HasSubstr("another map came before"));
}

TEST(CausalReport, ARunWithoutPosesIsStillJudged) {
  const TemporaryFolder folder;
  std::vector<FrameRow> rows;
  for (int i = 0; i < kImages; ++i) {
    rows.push_back(i % 2 == 0 ? publishedRow(0.05 * i, 0.01, "ORIENTATION") : silentRow(0.05 * i, "SHED"));
  }
  writeRunFolder(folder, {}, {}, rows, "");
  const RunReport report = evaluate(folder);
  EXPECT_FALSE(report.trajectory.report.has_value());
  EXPECT_EQ(report.availability.pose_in_time.count, 0U);
  EXPECT_EQ(report.availability.orientation_in_time.count, 100U);
  EXPECT_EQ(report.depth.source, SceneDepth::Source::kAssumed);
  EXPECT_EQ(report.depth.metres, 2.0);
  EXPECT_THAT(tableOf(report), HasSubstr("map: no pose"));
  EXPECT_THAT(tableOf(report), HasSubstr("no trajectory tells its scale"));
  EXPECT_THAT(yamlOf(report), HasSubstr("    ate: {rmse: .nan"));
}

TEST(CausalReport, ImagesThatRepeatOthersDoNotCount) {
  const TemporaryFolder folder;
  std::vector<FrameRow> rows;
  for (int i = 0; i < kImages; ++i) {
    rows.push_back(publishedRow(0.05 * i, 0.01, "ORIENTATION"));
    rows.push_back(silentRow(0.05 * i, "REPEATED"));
  }
  writeRunFolder(folder, {}, {}, rows, "");
  const Availability availability = evaluate(folder).availability;
  EXPECT_EQ(availability.orientation_in_time.of, static_cast<std::size_t>(kImages));
  EXPECT_EQ(availability.orientation_in_time.count, static_cast<std::size_t>(kImages));
  EXPECT_EQ(availability.images_by_status.at("REPEATED"), static_cast<std::size_t>(kImages));
}

TEST(CausalReport, DepthComesFromTheOptionTheSmoothedTrajectoryOrAGuess) {
  const TemporaryFolder folder;
  const std::vector<PoseRecord> poses = inOtherCoordinates(fromFirst(trueMotion()), kDepth);
  writeRunFolder(folder, {}, poses, usualRows(), "");
  const RunReport smoothed = evaluate(folder);
  EXPECT_EQ(smoothed.depth.source, SceneDepth::Source::kSmoothed);
  EXPECT_NEAR(smoothed.depth.metres, kDepth, 1e-6);
  EXPECT_EQ(smoothed.logged_without_pose, 170U);
  EXPECT_THAT(tableOf(smoothed), HasSubstr("170 images have a pose by frames.csv"));
  folder.write("run/summary.yaml", "metric_maps: 1\n");
  EXPECT_EQ(evaluate(folder).depth.source, SceneDepth::Source::kAssumed);
  EXPECT_THAT(tableOf(evaluate(folder)), HasSubstr("the map is in metres"));
  RunOptions options;
  options.depth = 10.0;  // 17 cm at 1.3 s, 20 cm at 1.35 s
  EXPECT_EQ(evaluate(folder, options).depth.source, SceneDepth::Source::kGiven);
  EXPECT_NEAR(evaluate(folder, options).parallax_time.value(), 1.35, 1e-9);
}

TEST(CausalReport, ClocksThatDifferAreTold) {
  const TemporaryFolder folder;
  std::vector<PoseRecord> poses = inOtherCoordinates(fromFirst(trueMotion()), kDepth);
  for (PoseRecord& pose : poses) {
    pose.time += 1000.0;
  }
  writeRunFolder(folder, poses, poses, usualRows(), "");
  const std::string message = messageOf([&] { evaluate(folder); });
  EXPECT_THAT(message, HasSubstr("the estimate covers 1001.500 to 1009.950 s, the ground truth 0.000 to 9.950 s"));
  EXPECT_THAT(message, HasSubstr("with -1001.500 s added"));
}

TEST(CausalReport, ClocksThatMostlyOverlapAreNotBlamed) {
  const std::vector<PoseRecord> truth = trueMotion();
  EXPECT_EQ(evaluateTrajectory(truth, fromFirst(truth), {}, {}).clock_hint, "");
  std::vector<PoseRecord> late = truth;
  for (PoseRecord& pose : late) {
    pose.time += 8.0;
  }
  EXPECT_THAT(evaluateTrajectory(truth, late, {}, {}).clock_hint, HasSubstr("with -8.000 s added"));
}

}  // namespace
}  // namespace mba_vo::causal_report_test
