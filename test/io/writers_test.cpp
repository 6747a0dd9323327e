#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "io/temporary_folder.h"
#include "mba_vo/io/frames_csv.h"
#include "mba_vo/io/loops_csv.h"
#include "mba_vo/io/online_record.h"
#include "mba_vo/io/progress_bar.h"
#include "mba_vo/io/run_writer.h"
#include "mba_vo/io/trajectory_writer.h"

namespace mba_vo::writers_test {
namespace {

using testing::HasSubstr;

TrajectoryEntry entryAt(std::int64_t mid_exposure_ns, MapId map) {
  TrajectoryEntry entry;
  entry.mid_exposure_ns = mid_exposure_ns;
  entry.map_id = map;
  entry.trajectory.T_reference_mid = SE3(Eigen::Quaterniond(0.8, 0.0, 0.6, 0.0), {1.0, -2.0, 0.123456789});
  entry.trajectory.velocity << 1.0, 0.0, 0.0, 0.0, 0.0, 0.0;  // along x of the camera
  entry.trajectory.exposure = 0.02;
  return entry;
}

std::string trajectoryOf(const std::vector<TrajectoryEntry>& entries) {
  std::ostringstream text;
  writeTrajectory(entries, text);
  return text.str();
}

TEST(TrajectoryWriter, WritesTumLinesWithNineDecimals) {
  EXPECT_THAT(trajectoryOf({entryAt(1305031453359684123, 1)}),
              HasSubstr("\n1305031453.359684123 1.000000000 -2.000000000 0.123456789 "
                        "0.000000000 0.600000000 0.000000000 0.800000000\n"));
}

TEST(TrajectoryWriter, SaysWhichMapAPoseBelongsTo) {
  const std::string text = trajectoryOf({entryAt(10, 1), entryAt(20, 1), entryAt(30, 4)});
  EXPECT_THAT(text, testing::ContainsRegex("# map 1\n0.000000010 .*\n0.000000020 .*\n# map 4\n0.000000030 "));
}

TEST(TrajectoryWriter, WritesStartAndEndOfTheExposure) {
  std::ostringstream text;
  writeExposureTrajectory({entryAt(5000000000, 1)}, text);
  // The camera's x axis is (0.28, 0, -0.96) in the map; half the motion is 0.01 m.
  EXPECT_THAT(text.str(),
              HasSubstr("\n5.000000000 0.020000000 "
                        "0.997200000 -2.000000000 0.133056789 0.000000000 0.600000000 0.000000000 0.800000000 "
                        "1.002800000 -2.000000000 0.113856789 0.000000000 0.600000000 0.000000000 0.800000000\n"));
}

TEST(TrajectoryWriter, SecondsAreExact) {
  EXPECT_EQ(formatSeconds(0), "0.000000000");
  EXPECT_EQ(formatSeconds(1305031453000000001), "1305031453.000000001");
  EXPECT_EQ(formatSeconds(-1500000000), "-1.500000000");
  EXPECT_EQ(formatSeconds(-5), "-0.000000005");
}

TEST(RunWriter, FramesCsvHasARowPerFrameAndEmptyFieldsForTheUnknown) {
  FrameRecord lost;
  lost.sequence = 7;
  lost.mid_exposure_ns = 1500000000;
  lost.stamp_ns = 1490000000;
  lost.status = "LOST";
  lost.reason = "a \"reason\", with comma";
  FrameRecord good = lost;
  good.status = "TRACKING";
  good.reason = "";
  good.exposure = 0.02;
  good.map = 2;
  good.blur_length_px = 12.345;
  good.points_used = 400;
  good.residual_rms = 3.25;
  good.pixel_error = 0.5;
  good.tracking_ms = 6.5;
  constexpr double kVariances[] = {1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
  lost.online_status = "LOST";
  good.online_status = "TRACKING";
  good.arrival = 1.51;
  good.published = 1.525;
  const Matrix6 diagonal = Eigen::Map<const Vector6>(kVariances).asDiagonal();
  good.online = OnlinePose{2, {SE3(), Eigen::Map<const Vector6>(kVariances)}, SE3(), diagonal, 2.0 * diagonal};
  std::ostringstream text;
  writeFrames({lost, good}, text);
  EXPECT_EQ(
      text.str(),
      "sequence,time,stamp,exposure,status,reason,map,blur_px,points,residual,error_px,tracking_ms,mapping_ms,message,"
      "arrival,published,online_status,covariance,twist,twist_covariance\n"
      "7,1.500000000,1.490000000,,LOST,\"a \"\"reason\"\", with comma\",,,,,,0.000,0.000,\"\",0.000000,,LOST,,,\n"
      "7,1.500000000,1.490000000,0.020000,TRACKING,\"\",2,12.35,400,3.250,0.500,6.500,0.000,\"\",1.510000,1.525000,"
      "TRACKING,1 0 0 0 0 0 2 0 0 0 0 3 0 0 0 4 0 0 5 0 6,1 2 3 4 5 6,2 0 0 0 0 0 4 0 0 0 0 6 0 0 0 8 0 0 10 0 12\n");
}

TEST(RunWriter, KeyframesCsvHasARowPerKeyframe) {
  KeyframeReport report;
  report.keyframe_id = 3;
  report.total_ms = 12.5;
  report.depths = {40, 30};
  std::ostringstream text;
  writeKeyframes({report, report}, text);
  EXPECT_THAT(text.str(), HasSubstr("keyframe,sequence,time,"));
  EXPECT_THAT(text.str(), testing::ContainsRegex("\n3,0,0.000000000,.*,12.500,40,30\n3,"));
}

TEST(RunWriter, WritesAllFilesAndAReadableSummary) {
  const TemporaryFolder folder;
  OfflineResult result;
  result.trajectory = {entryAt(10, 1)};
  result.times.tracking = 2.0;
  result.exposure = {2.5, 0.03, true};
  result.times.cpu = 3.0;
  PublishedImage rejected;
  rejected.step.kind = TrackerStep::Kind::kRejected;
  rejected.step.sequence = 9;
  result.log.add({{rejected}, {}, {}, 0.0});
  result.log.settle(result.trajectory);
  writeRun(folder.file("new/run"), result, {{"sequence", "C:\\my \"room\""}});
  for (const char* name : {"trajectory.txt", "exposure_trajectory.txt", "frames.csv", "keyframes.csv"}) {
    EXPECT_NE(folder.read(std::string("new/run/") + name), "") << name;
  }
  const YAML::Node summary = YAML::LoadFile(folder.file("new/run/summary.yaml"));
  EXPECT_EQ(summary["sequence"].as<std::string>(), "C:\\my \"room\"");
  EXPECT_EQ(summary["frames"].as<int>(), 1);
  EXPECT_EQ(summary["rejected"].as<int>(), 1);
  EXPECT_DOUBLE_EQ(summary["exposure_ratio"].as<double>(), 2.5);
  EXPECT_DOUBLE_EQ(summary["exposure_ratio_sigma"].as<double>(), 0.03);
  EXPECT_TRUE(summary["exposure_ratio_used"].as<bool>());
  EXPECT_DOUBLE_EQ(summary["times"]["tracking"]["per_frame_ms"].as<double>(), 2000.0);
  EXPECT_DOUBLE_EQ(summary["cpu"]["total_s"].as<double>(), 3.0);
  EXPECT_GT(summary["peak_memory_mb"].as<double>(), 1.0);
}

TEST(RunWriter, PlacesThatCannotBeWrittenAreNamed) {
  const TemporaryFolder folder;
  const std::string file = folder.write("file", "");
  EXPECT_THAT(messageOf([&] { writeRun(file + "/run", {}, {}); }), HasSubstr(file + "/run: cannot be made"));
  std::filesystem::create_directories(folder.file("run/frames.csv"));
  EXPECT_THAT(messageOf([&] { writeRun(folder.file("run"), {}, {}); }), HasSubstr("frames.csv: cannot be written"));
}

TEST(RunWriter, AFullDiskIsNamed) {
  const auto few = [](std::ostream& out) { out << "a line\n"; };
  const auto many = [](std::ostream& out) { out << std::string(1000000, ' '); };
  for (const auto& content : {std::function<void(std::ostream&)>(few), std::function<void(std::ostream&)>(many)}) {
    EXPECT_EQ(messageOf([&] { writeFile("/dev/full", content); }),
              "/dev/full: cannot be written: No space left on device");
  }
  EXPECT_EQ(messageOf([&] { writeFile("/nonexistent/file", few); }),
            "/nonexistent/file: cannot be written: No such file or directory");
}

TEST(OnlineRecord, AFullDiskIsNamed) {
  const TemporaryFolder folder;
  for (const char* name : {"online_trajectory.txt", "online_odometry.txt"}) folder.write(name, "");
  std::filesystem::create_symlink("/dev/full", folder.file("frames.csv"));
  OnlineRecord record(folder.file(""));
  PublishedImage rejected;
  rejected.step.kind = TrackerStep::Kind::kRejected;
  EXPECT_THAT(messageOf([&] { record.add(rejected); }), HasSubstr("cannot be written: No space left on device"));
  EXPECT_NO_THROW(record.add(rejected)) << "it is said once";
}

TEST(OnlineRecord, HasARowForEveryImageAlsoForThoseThatWereShed) {
  const TemporaryFolder folder;
  OnlineRecord record(folder.file(""));
  for (const std::uint64_t number : {4, 2, 1}) {
    TrackerStep shed;
    shed.kind = TrackerStep::Kind::kShed;
    shed.sequence = number;
    record.addShed(shed);
  }
  for (const std::uint64_t number : {0, 3}) {
    PublishedImage rejected;
    rejected.step.kind = TrackerStep::Kind::kRejected;
    rejected.step.sequence = number;
    record.add(rejected);
  }
  const std::string row = ",0.000000000,0.000000000,,";
  const std::string rows = "\n0" + row + "REJECTED.*\n1" + row + "SHED.*\n2" + row + "SHED.*\n3" + row + "REJECTED.*\n";
  EXPECT_THAT(folder.read("frames.csv"), testing::ContainsRegex(rows + "$"));
  record.finish();
  EXPECT_THAT(folder.read("frames.csv"), testing::ContainsRegex(rows + "4" + row + "SHED"));
}

TEST(ProgressBar, TellsTheTimeLeft) {
  EXPECT_EQ(timeLeft(0, 100, 0.0), "? left");
  EXPECT_EQ(timeLeft(20, 100, 16.2), "1:05 left");
  EXPECT_EQ(timeLeft(1, 7211, 1.0), "2:00:10 left");
  EXPECT_EQ(timeLeft(100, 100, 65.0), "in 1:05");
}

TEST(ProgressBar, WhatIsLeftOutDoesNotCount) {
  std::ostringstream text;
  {
    ProgressBar bar(text, 12, true, 10);
    bar.update(10);
    EXPECT_EQ(text.str(), "");
    bar.update(11);
  }
  EXPECT_THAT(text.str(), HasSubstr(" 1/2, "));
}

TEST(ProgressBar, DrawsOnlyWhenEnabled) {
  std::ostringstream off;
  std::ostringstream on;
  for (auto* out : {&off, &on}) {
    ProgressBar bar(*out, 2, out == &on);
    bar.update(1);
    bar.update(2);
  }
  EXPECT_EQ(off.str(), "");
  EXPECT_THAT(on.str(), HasSubstr("1/2"));
  EXPECT_THAT(on.str(), HasSubstr(" left"));
  EXPECT_THAT(on.str(), HasSubstr("2/2"));
}

TEST(LoopsCsv, SaysOfEveryPairWhatCameOfIt) {
  LoopTrial closed, rejected;
  closed.older_map = 2;
  closed.newer_map = 3;
  closed.older = 4;
  closed.newer = 90;
  closed.older_ns = 1'500'000'000;
  closed.verdict.S_old_new = Sim3(SE3(Eigen::Quaterniond::Identity(), {0.1, 0.2, 0.3}), std::exp(0.02));
  closed.verdict.covariance = 1e-4 * Matrix7::Identity();
  rejected.verdict.rejected_because = "too little in common: 0.1";
  std::ostringstream out;
  writeLoops({closed, rejected}, out);
  const std::string text = out.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3);
  EXPECT_NE(text.find("\n2,3,4,90,1.500000000,0.000000000,"), std::string::npos) << text;
  EXPECT_NE(text.find(",0.100000,0.200000,0.300000,0.000000,0.000000,0.000000,1.000000,0.020000,0.010000,"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find(",\"too little in common: 0.1\"\n"), std::string::npos) << text;
}

}  // namespace
}  // namespace mba_vo::writers_test
