#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "io/temporary_folder.h"
#include "mba_vo/evaluation/report_writer.h"
#include "mba_vo/evaluation/trajectory_plot.h"

namespace mba_vo::report_test {
namespace {

using testing::HasSubstr;

std::vector<PoseRecord> circle() {
  std::vector<PoseRecord> poses;
  for (int i = 0; i < 60; ++i) {
    const double t = 0.1 * i;
    poses.push_back({t, SE3(Eigen::Quaterniond::Identity(), {std::cos(t), 0.1 * t, std::sin(t)}), std::nullopt, 0});
  }
  return poses;
}

EvaluationReport reportOfCircle() { return evaluateTrajectory(circle(), circle(), {}, {}); }

int countPixels(const cv::Mat& image, const cv::Vec3b& bgr) {
  cv::Mat mask;
  cv::inRange(image, cv::Scalar(bgr), cv::Scalar(bgr), mask);
  return cv::countNonZero(mask);
}

std::size_t countOf(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    ++count;
  }
  return count;
}

TEST(Report, TableAndYamlTellTheFigures) {
  EvaluationReport report = reportOfCircle();
  report.absolute.rmse = 0.0125;
  report.drops = {60, 6, 57, 3};
  std::ostringstream table;
  writeTable(report, table);
  EXPECT_THAT(table.str(), HasSubstr("0.01250"));
  EXPECT_THAT(table.str(), HasSubstr("6 of 60 (10.0 %)"));
  EXPECT_THAT(table.str(), HasSubstr("3 of 57 (5.3 %)"));
  std::ostringstream yaml;
  writeYaml(report, yaml);
  EXPECT_THAT(yaml.str(), HasSubstr("ate: {rmse: 0.0125"));
  EXPECT_THAT(yaml.str(), HasSubstr("dropped_percent: 10\n"));
  report.relative_translation = summarize({});
  std::ostringstream without_rpe;
  writeYaml(report, without_rpe);
  EXPECT_THAT(without_rpe.str(), HasSubstr("rpe_translation: {rmse: .nan"));
}

TEST(Plot, PngShowsBothCurvesInBothViews) {
  const TemporaryFolder folder;
  const std::string file = folder.file("plot.png");
  EvaluationReport report = reportOfCircle();
  for (PosePair& pair : report.pairs) {  // shifted, so that it does not hide the ground truth
    pair.estimate = SE3(pair.estimate.rotation(), pair.estimate.translation() + Eigen::Vector3d(0.2, 0.3, 0.2));
  }
  plotTrajectory(file, circle(), report);
  const cv::Mat image = cv::imread(file);
  ASSERT_FALSE(image.empty());
  for (const int left : {0, image.cols / 2}) {
    const cv::Mat panel = image(cv::Rect(left, 60, image.cols / 2, image.rows - 60));
    EXPECT_GT(countPixels(panel, {30, 30, 200}), 200);
    EXPECT_GT(countPixels(panel, {120, 120, 120}), 200);
  }
}

TEST(Plot, SvgHasAxesLegendAndCurves) {
  const TemporaryFolder folder;
  plotTrajectory(folder.file("plot.svg"), circle(), reportOfCircle());
  const std::string svg = folder.read("plot.svg");
  for (const char* text : {"<svg", "</svg>", "from above", "from the side", "x [m]", "z [m]", "ground truth"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
}

TEST(Plot, GapsAreNotBridged) {
  const TemporaryFolder folder;
  const std::string kRed = "rgb(200,30,30)";
  EvaluationReport report = reportOfCircle();
  plotTrajectory(folder.file("whole.svg"), circle(), report);
  report.pairs.erase(report.pairs.begin() + 20, report.pairs.begin() + 25);
  plotTrajectory(folder.file("gap.svg"), circle(), report);
  EXPECT_EQ(countOf(folder.read("gap.svg"), kRed), countOf(folder.read("whole.svg"), kRed) + 2);
}

TEST(Plot, TwoEstimatesHaveTheirOwnColoursAndGaps) {
  const TemporaryFolder folder;
  EvaluationReport online = reportOfCircle();
  for (PosePair& pair : online.pairs) {
    pair.estimate = SE3(pair.estimate.rotation(), pair.estimate.translation() + Eigen::Vector3d(0.2, 0.3, 0.2));
  }
  EvaluationReport smoothed = reportOfCircle();
  for (PosePair& pair : smoothed.pairs) {
    pair.estimate = SE3(pair.estimate.rotation(), pair.estimate.translation() - Eigen::Vector3d(0.2, 0.3, 0.2));
  }
  plotTrajectories(folder.file("plot.png"), circle(), {{"online", &online}, {"smoothed", &smoothed}});
  const cv::Mat image = cv::imread(folder.file("plot.png"));
  for (const int left : {0, image.cols / 2}) {
    const cv::Mat panel = image(cv::Rect(left, 60, image.cols / 2, image.rows - 60));
    EXPECT_GT(countPixels(panel, {30, 30, 200}), 200);
    EXPECT_GT(countPixels(panel, {200, 90, 30}), 200);
  }
  online.pairs.erase(online.pairs.begin() + 20, online.pairs.begin() + 25);
  plotTrajectories(folder.file("plot.svg"), circle(), {{"online", &online}, {"smoothed", &smoothed}});
  const std::string svg = folder.read("plot.svg");
  EXPECT_THAT(svg, HasSubstr("online, aligned"));
  EXPECT_THAT(svg, HasSubstr("smoothed, aligned"));
  EXPECT_EQ(countOf(svg, "rgb(200,30,30)"), countOf(svg, "rgb(30,90,200)") + 2);  // one piece more in each view
}

TEST(Plot, BadFilesAreNamed) {
  EXPECT_THAT(messageOf([] { plotTrajectory("plot.pdf", circle(), reportOfCircle()); }), HasSubstr("'plot.pdf'"));
  for (const char* file : {"/nonexistent/plot.png", "/nonexistent/plot.svg"}) {
    EXPECT_THAT(messageOf([&] { plotTrajectory(file, circle(), reportOfCircle()); }), HasSubstr(file));
  }
}

TEST(Plot, AFullDiskIsNamed) {
  const TemporaryFolder folder;
  for (const char* name : {"plot.png", "plot.svg"}) {
    std::filesystem::create_symlink("/dev/full", folder.file(name));
    EXPECT_EQ(messageOf([&] { plotTrajectory(folder.file(name), circle(), reportOfCircle()); }),
              folder.file(name) + ": cannot be written: No space left on device");
  }
}

TEST(Plot, TicksAreRound) {
  EXPECT_THAT(roundTicks(-0.9, 1.3, 5), testing::ElementsAre(-0.5, 0.0, 0.5, 1.0));
  EXPECT_EQ(roundTicks(0.0, 10.0, 5).size(), 6U);
}

}  // namespace
}  // namespace mba_vo::report_test
