// What makes a simulated camera like those of users: exposures that vary, automatic gain, compression, and a
// calibration that is a little wrong.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "mba_vo/simulation/folder_sink.h"
#include "mba_vo/simulation/frame_cache.h"
#include "simulation/test_scenes.h"

namespace mba_vo::camera_test {
namespace {

namespace fs = std::filesystem;

SimulationConfig varying() {
  SimulationConfig config = smallConfig();
  config.exposure = 0.01;
  config.exposure_min = 0.004;
  config.exposure_max = 0.016;
  config.exposure_period = 4.0;
  return config;
}

bool same(const cv::Mat& a, const cv::Mat& b) { return a.size() == b.size() && cv::countNonZero(a != b) == 0; }

TEST(Exposures, SwingSmoothlyBetweenTheirLimits) {
  const ExposureProgramme programme(varying());
  double lowest = 1.0;
  double highest = 0.0;
  for (double t = 0.0; t < 4.0; t += 0.01) {
    const double now = programme.exposure(t);
    lowest = std::min(lowest, now);
    highest = std::max(highest, now);
    EXPECT_NEAR(programme.exposure(t + 4.0), now, 1e-9);
    EXPECT_NEAR(now * programme.exposure(t + 2.0), 0.004 * 0.016, 1e-9);  // sinusoidal in the logarithm
    EXPECT_LT(std::abs(std::log(programme.exposure(t + 0.01) / now)), 0.012);
  }
  EXPECT_NEAR(lowest, 0.004, 1e-6);
  EXPECT_NEAR(highest, 0.016, 1e-6);
}

TEST(Exposures, FramesAreBlurredForAsLongAsTheySay) {
  const Simulator simulator(varying(), sharedRoom());
  std::set<double> different;
  for (const int index : {0, 20, 40, 60, 80}) {
    const SimulatedFrame frame = simulator.groundTruth(index);
    const double t = simulator.time(index);
    EXPECT_EQ((simulator.pose(t - 0.5 * frame.exposure).inverse() * frame.T_world_start).log().norm(), 0.0);
    EXPECT_EQ((simulator.pose(t + 0.5 * frame.exposure).inverse() * frame.T_world_end).log().norm(), 0.0);
    different.insert(frame.exposure);
  }
  EXPECT_EQ(different.size(), 5U);
}

/// An image from the light of the scene while the shutter is open, by this test's own arithmetic: the mean of many
/// instants.
cv::Mat1f meanOfInstants(const Simulator& simulator, int index, double exposure) {
  constexpr int kInstants = 80;
  cv::Mat1f sum(simulator.camera().height, simulator.camera().width, 0.0F);
  for (int i = 0; i < kInstants; ++i) {
    const double t = simulator.time(index) + exposure * ((i + 0.5) / kInstants - 0.5);
    sum += simulator.renderer().integrate([&](double u) { return simulator.pose(u); }, t, 0.0);
  }
  sum /= kInstants;
  return sum;
}

TEST(Exposures, WithoutGainTheBrightnessFollows) {
  SimulationConfig config = varying();
  config.noise = 0.0;
  const Simulator simulator(config, sharedRoom());
  for (const int index : {10, 60}) {
    const SimulatedFrame frame = simulator.render(index);
    cv::Mat1f expected = meanOfInstants(simulator, index, frame.exposure);
    expected *= frame.exposure / 0.01;
    cv::min(expected, 255.0, expected);
    cv::Mat1f image;
    frame.blurred.convertTo(image, CV_32F);
    EXPECT_LT(cv::norm(image, expected, cv::NORM_L1) / static_cast<double>(image.total()), 0.6) << frame.exposure;
  }
}

TEST(AutoGain, HoldsTheBrightnessAndAmplifiesTheNoise) {
  SimulationConfig config = varying();
  config.noise = 2.0;
  config.auto_gain = true;
  const Simulator simulator(config, sharedRoom());
  config.noise = 0.0;
  const Simulator clean(config, sharedRoom());
  for (const int index : {5, 20, 45, 75}) {
    const SimulatedFrame frame = simulator.render(index);
    const cv::Mat1b noiseless = clean.render(index).blurred;
    const double light = cv::mean(meanOfInstants(simulator, index, frame.exposure))[0];
    EXPECT_NEAR(cv::mean(noiseless)[0], light, 0.5) << frame.exposure;
    cv::Mat1f difference;
    cv::subtract(frame.blurred, noiseless, difference, cv::noArray(), CV_32F);
    cv::Scalar mean, deviation;
    cv::meanStdDev(difference, mean, deviation);
    const double expected = 2.0 * 0.01 / frame.exposure;
    EXPECT_NEAR(deviation[0], std::hypot(expected, std::sqrt(1.0 / 12.0)), 0.06 * expected) << frame.exposure;
  }
}

TEST(AutoGain, ErrsAsMuchAsAskedFor) {
  SimulationConfig config = varying();
  config.auto_gain = true;
  config.gain_error = 0.15;
  const ExposureProgramme programme(config);
  double lowest = 1.0;
  double highest = 1.0;
  for (double t = 0.0; t < 60.0; t += 0.02) {
    const double product = programme.brightness(t);
    EXPECT_NEAR(programme.gain(t) * programme.exposure(t) / 0.01, product, 1e-9);
    EXPECT_LT(std::abs(std::log(programme.brightness(t + 0.02) / product)), 0.015);
    lowest = std::min(lowest, product);
    highest = std::max(highest, product);
  }
  EXPECT_LE(highest, 1.15);
  EXPECT_GE(lowest, 1.0 / 1.15);
  EXPECT_GT(highest, 1.1);
  EXPECT_LT(lowest, 0.91);
}

TEST(Jpeg, LosesWhatItSavesAndSparesTheSharpImage) {
  SimulationConfig config = smallConfig();
  config.sharp = true;
  const SimulatedFrame original = Simulator(config, sharedRoom()).render(4);
  EXPECT_TRUE(original.jpeg.empty());
  double previous = 0.0;
  for (const int quality : {90, 50, 15}) {
    config.jpeg = quality;
    const SimulatedFrame frame = Simulator(config, sharedRoom()).render(4);
    EXPECT_TRUE(same(frame.sharp, original.sharp));
    EXPECT_TRUE(same(frame.blurred, cv::imdecode(frame.jpeg, cv::IMREAD_UNCHANGED)));
    const double error =
        cv::norm(frame.blurred, original.blurred, cv::NORM_L1) / static_cast<double>(frame.blurred.total());
    EXPECT_GT(error, previous + 0.2) << quality;
    EXPECT_LT(error, 8.0) << quality;
    previous = error;
  }
}

class CameraFolder : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(testing::TempDir()) / (std::string("mba_vo_camera_") + info->name());
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// Text of a file of the sequence that `config` makes, three frames long.
  void write(SimulationConfig config, const std::string& cache = "") {
    config.duration = 2.0 / config.rate;
    const Simulator simulator(config, sharedRoom());
    FolderSink sink(folder_.string(), config.toldCalibration(), true);
    renderSequence(simulator, sink, cache);
  }
  std::string text(const std::string& name) const {
    std::ifstream in(folder_ / name);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  fs::path folder_;
};

TEST_F(CameraFolder, HoldsTheCompressedImages) {
  SimulationConfig config = smallConfig();
  config.jpeg = 60;
  const std::string cache = (folder_ / "cache").string();
  for (int run = 0; run < 2; ++run) {  // the second from the cache
    write(config, cache);
    config.duration = 2.0 / config.rate;
    const SimulatedFrame frame = Simulator(config, sharedRoom()).render(1);
    const std::string bytes = text("images/000001.jpg");
    EXPECT_EQ(bytes, std::string(frame.jpeg.begin(), frame.jpeg.end()));
    EXPECT_FALSE(fs::exists(folder_ / "images" / "000001.png"));
  }
}

TEST_F(CameraFolder, TellsTheTrueExposureOrNone) {
  SimulationConfig config = varying();
  config.hide_exposure = true;
  EXPECT_EQ(config.fingerprint(), varying().fingerprint());
  for (const bool hidden : {false, true}) {
    config.hide_exposure = hidden;
    write(config);
    config.duration = 2.0 / config.rate;
    const Simulator simulator(config, sharedRoom());
    std::istringstream told(text("times.txt")), truth(text("groundtruth_exposure.txt"));
    std::string line;
    std::getline(told, line);
    std::getline(truth, line);
    for (int i = 0; i < 3; ++i) {
      double id, t, milliseconds, seconds;
      told >> id >> t >> milliseconds;
      truth >> t >> seconds;
      std::getline(truth, line);
      EXPECT_NEAR(seconds, simulator.exposures().exposure(i / config.rate), 1e-6);
      EXPECT_NEAR(milliseconds, hidden ? 0.0 : 1e3 * seconds, 1e-3);
    }
  }
}

TEST_F(CameraFolder, TellsTheCalibrationWithItsErrorsAndRendersWithout) {
  SimulationConfig config = smallConfig();
  config.distortion = {-0.1, 0.02, 0.0, 0.001};
  config.duration = 2.0 / config.rate;
  const cv::Mat1b image = Simulator(config, sharedRoom()).render(2).blurred;
  const std::string base = config.fingerprint();
  config.calibration_focal_error = 0.02;
  config.calibration_centre_error = -1.5;
  EXPECT_EQ(config.fingerprint(), base);
  write(config);
  EXPECT_TRUE(same(cv::imread((folder_ / "images" / "000002.png").string(), cv::IMREAD_UNCHANGED), image));
  const std::string camera = text("camera.yaml");
  EXPECT_NE(camera.find("data: [109.65, 0, 92, 0, 109.65, 58, 0, 0, 1]"), std::string::npos) << camera;
  EXPECT_NE(camera.find("data: [-0.1, 0.02, 0, 0.001]"), std::string::npos) << camera;
}

}  // namespace
}  // namespace mba_vo::camera_test
