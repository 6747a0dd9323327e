#include "mba_vo/io/calibrated_run.h"

#include <memory>
#include <optional>

#include <gtest/gtest.h>

#include "mba_vo/odometry/config_yaml.h"
#include "support/rendered_sequence.h"

namespace mba_vo {
namespace {

constexpr double kExposure = 0.02;  // [s]
constexpr int kFrames = 60;

const test::RenderedSequence& sequence() {
  static const test::RenderedSequence sequence = [] {
    SimulationConfig config = test::sequenceConfig(kExposure);
    config.trajectory_seed = 3;
    return test::renderFrames(config, 0, kFrames);
  }();
  return sequence;
}

/// Plays the rendered images, telling `exposure`.
class RenderedReader : public SequenceReader {
 public:
  explicit RenderedReader(std::optional<double> exposure) : exposure_(exposure) {}
  CameraCalibration calibration() const override { return sequence().calibration; }
  std::size_t size() const override { return sequence().frames.size(); }
  std::optional<CameraImage> next() override {
    if (next_ == size()) return std::nullopt;
    const SimulatedFrame& f = sequence().frames[next_++];
    return CameraImage{f.id, f.mid_exposure_ns, f.mid_exposure_ns, exposure_, f.blurred, "", {}};
  }

 private:
  std::optional<double> exposure_;
  std::size_t next_ = 0;
};

OfflineResult run(std::optional<double> told, int& announced) {
  OfflineOptions options;
  options.config.mapper.deterministic = true;
  finalize(options.config);
  CalibratedRun run;
  run.open = [&] { return std::make_unique<RenderedReader>(told); };
  run.progress = [](std::size_t) {};
  run.onRestart = [&](const OfflineResult&) { ++announced; };
  return runCalibrated(run, options);
}

TEST(CalibratedRun, ExposuresThatDidNotComeAreLearntAndTheRunIsBegunAnewWithThem) {
  int announced = 0;
  const OfflineResult result = run(std::nullopt, announced);
  EXPECT_EQ(result.restarts, 1);
  EXPECT_EQ(announced, 1);
  ASSERT_TRUE(result.exposure_correction.missing);
  EXPECT_NEAR(*result.exposure_correction.missing, kExposure, 0.05 * kExposure);
  ASSERT_EQ(result.log.frames().size(), static_cast<std::size_t>(kFrames));
  EXPECT_EQ(result.log.frames().front().exposure, result.exposure_correction.missing) << "from the first image on";
}

TEST(CalibratedRun, ExposuresThatAreWrongAreCorrectedFromTheBeginning) {
  int announced = 0;
  const OfflineResult result = run(0.5 * kExposure, announced);
  EXPECT_EQ(result.restarts, 1);
  EXPECT_NEAR(result.exposure_correction.factor, 2.0, 0.2);
  EXPECT_FALSE(result.exposure_correction.missing);
  EXPECT_NEAR(result.log.frames().front().exposure.value(), kExposure, 0.1 * kExposure);
}

TEST(CalibratedRun, WhereNothingIsToBeLearntItRunsOnce) {
  int announced = 0;
  const OfflineResult result = run(kExposure, announced);
  EXPECT_EQ(result.restarts, 0);
  EXPECT_EQ(announced, 0);
  EXPECT_EQ(result.exposure_correction, ExposureCorrection());
}

}  // namespace
}  // namespace mba_vo
