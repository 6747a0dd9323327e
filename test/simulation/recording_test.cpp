#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "mba_vo/simulation/folder_sink.h"
#include "mba_vo/simulation/frame_cache.h"
#include "simulation/test_scenes.h"

namespace mba_vo::recording_test {
namespace {

namespace fs = std::filesystem;

class Recording : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(testing::TempDir()) / (std::string("mba_vo_recording_") + info->name());
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static SimulationConfig shortConfig() {
    SimulationConfig config = smallConfig();
    config.duration = 3.0 / 27.0;
    config.sharp = config.depth = true;
    return config;
  }

  fs::path folder_;
};

class MemorySink : public SequenceSink {
 public:
  void write(const SimulatedFrame& frame) override { frames.push_back(frame); }
  void finish() override { ++finished; }
  std::vector<SimulatedFrame> frames;
  int finished = 0;
};

bool same(const cv::Mat& a, const cv::Mat& b) { return a.size() == b.size() && cv::countNonZero(a != b) == 0; }

std::vector<std::vector<double>> numbers(const fs::path& file) {
  std::ifstream in(file);
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    rows.emplace_back();
    for (double value; words >> value;) rows.back().push_back(value);
  }
  return rows;
}

SE3 poseAt(const std::vector<double>& row, std::size_t i) {
  return SE3(Eigen::Quaterniond(row[i + 6], row[i + 3], row[i + 4], row[i + 5]), {row[i], row[i + 1], row[i + 2]});
}

TEST_F(Recording, FolderHoldsWhatWasSimulated) {
  const Simulator simulator(shortConfig(), sharedRoom());
  FolderSink sink(folder_.string(), simulator.calibration());
  renderSequence(simulator, sink, "");
  const auto times = numbers(folder_ / "times.txt");
  const auto poses = numbers(folder_ / "groundtruth.txt");
  const auto exposures = numbers(folder_ / "groundtruth_exposure.txt");
  const auto blur = numbers(folder_ / "blur_px.txt");
  ASSERT_EQ(times.size(), 4U);
  ASSERT_EQ(poses.size(), 4U);
  ASSERT_EQ(exposures.size(), 4U);
  ASSERT_EQ(blur.size(), 4U);
  for (int i = 0; i < 4; ++i) {
    const auto row = static_cast<std::size_t>(i);
    const SimulatedFrame frame = simulator.render(i);
    const std::string name = "00000" + std::to_string(i) + ".png";
    EXPECT_TRUE(same(cv::imread((folder_ / "images" / name).string(), cv::IMREAD_UNCHANGED), frame.blurred));
    EXPECT_TRUE(same(cv::imread((folder_ / "images_sharp" / name).string(), cv::IMREAD_UNCHANGED), frame.sharp));
    cv::Mat depth = cv::imread((folder_ / "depth" / name).string(), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(depth.type(), CV_16U);
    depth.convertTo(depth, CV_32F, 1.0 / 5000.0);
    EXPECT_LT(cv::norm(depth, frame.depth, cv::NORM_INF), 1.1e-4);
    EXPECT_EQ(times[row][0], i);
    EXPECT_NEAR(times[row][1], 1000.0 + i / 27.0, 1e-8);
    EXPECT_EQ(times[row][2], 20.0);
    EXPECT_NEAR(poses[row][0], 1000.0 + i / 27.0, 1e-8);
    EXPECT_LT((poseAt(poses[row], 1).inverse() * frame.T_world_mid).log().norm(), 1e-8);
    EXPECT_EQ(exposures[row][1], 0.02);
    EXPECT_LT((poseAt(exposures[row], 2).inverse() * frame.T_world_start).log().norm(), 1e-8);
    EXPECT_LT((poseAt(exposures[row], 9).inverse() * frame.T_world_end).log().norm(), 1e-8);
    EXPECT_NEAR(blur[row][0], frame.blur_px, 0.006);
  }
}

TEST_F(Recording, CameraFileIsCompleteYaml) {
  SimulationConfig config = shortConfig();
  config.distortion = {-0.1, 0.02, 0.0, 0.001};
  FolderSink sink(folder_.string(), config.calibration());
  std::ifstream in(folder_ / "camera.yaml");
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  for (const char* part : {"image_width: 188", "image_height: 120", "distortion_model: plumb_bob",
                           "distortion_coefficients: {rows: 1, cols: 4, data: [-0.1, 0.02, 0, 0.001]}",
                           "camera_matrix: {rows: 3, cols: 3, data: [107.5, 0, 93.5, 0, 107.5, 59.5, 0, 0, 1]}",
                           "projection_matrix: {rows: 3, cols: 4"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
  }
}

TEST_F(Recording, WritesOverASequenceOnlyWhenTold) {
  const CameraCalibration calibration = shortConfig().calibration();
  { FolderSink sink(folder_.string(), calibration); }
  EXPECT_THROW(FolderSink(folder_.string(), calibration), std::runtime_error);
  std::ofstream(folder_ / "images" / "000009.png") << "of an earlier, longer sequence";
  EXPECT_NO_THROW(FolderSink(folder_.string(), calibration, true));
  EXPECT_FALSE(fs::exists(folder_ / "images" / "000009.png"));
  EXPECT_THROW(FolderSink("/dev/null/sequence", calibration), std::runtime_error);
}

TEST_F(Recording, AFullDiskIsNamed) {
  fs::create_directories(folder_);
  fs::create_symlink("/dev/full", folder_ / "blur_px.txt");
  FolderSink sink(folder_.string(), shortConfig().calibration());
  SimulatedFrame frame;
  frame.blurred = cv::Mat1b(4, 4, std::uint8_t{0});
  std::string message;
  try {
    sink.write(frame);
  } catch (const std::runtime_error& error) {
    message = error.what();
  }
  EXPECT_EQ(message, "cannot write '" + (folder_ / "*.txt").string() + "': No space left on device");
}

TEST_F(Recording, CacheGivesBackTheSameFrames) {
  const Simulator simulator(shortConfig(), sharedRoom());
  MemorySink rendered, stored;
  renderSequence(simulator, rendered, folder_.string());
  renderSequence(simulator, stored, folder_.string());
  ASSERT_EQ(rendered.frames.size(), 4U);
  ASSERT_EQ(stored.frames.size(), 4U);
  EXPECT_EQ(stored.finished, 1);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_TRUE(same(rendered.frames[i].blurred, stored.frames[i].blurred));
    EXPECT_TRUE(same(rendered.frames[i].sharp, stored.frames[i].sharp));
    EXPECT_TRUE(same(rendered.frames[i].depth, stored.frames[i].depth));
    EXPECT_EQ(rendered.frames[i].mid_exposure_ns, stored.frames[i].mid_exposure_ns);
    EXPECT_EQ((rendered.frames[i].T_world_end.inverse() * stored.frames[i].T_world_end).log().norm(), 0.0);
  }
}

TEST_F(Recording, CacheIsReallyReadAndSurvivesDamage) {
  const SimulationConfig config = shortConfig();
  const Simulator simulator(config, sharedRoom());
  const FrameCache cache(folder_.string(), config);
  const SimulatedFrame frame = renderCached(simulator, 0, cache);
  const std::string file = cache.folder() + "/000000_blurred.png";
  cv::imwrite(file, cv::Mat1b(120, 188, std::uint8_t{7}));
  EXPECT_EQ(renderCached(simulator, 0, cache).blurred(60, 90), 7) << "the stored image is not used";
  std::ofstream(file) << "not an image";
  EXPECT_TRUE(same(renderCached(simulator, 0, cache).blurred, frame.blurred));
  fs::resize_file(cache.folder() + "/000000_depth.f32", 100);
  EXPECT_TRUE(same(renderCached(simulator, 0, cache).depth, frame.depth));
}

TEST_F(Recording, CacheKeepsDifferentParametersApart) {
  SimulationConfig config = shortConfig();
  const FrameCache first(folder_.string(), config);
  config.noise = 1.5;
  EXPECT_NE(FrameCache(folder_.string(), config).folder(), first.folder());
  EXPECT_THROW(FrameCache("/dev/null/cache", config), std::runtime_error);
}

TEST_F(Recording, ProgressCanStopTheSequence) {
  const Simulator simulator(shortConfig(), sharedRoom());
  MemorySink sink;
  renderSequence(simulator, sink, "", [](int done) { return done < 2; });
  EXPECT_EQ(sink.frames.size(), 2U);
  EXPECT_EQ(sink.finished, 1);
}

}  // namespace
}  // namespace mba_vo::recording_test
