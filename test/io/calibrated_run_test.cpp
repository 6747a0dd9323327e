#include "mba_vo/io/calibrated_run.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "mba_vo/odometry/config_yaml.h"
#include "support/rendered_sequence.h"

namespace mba_vo::calibrated_run_test {
namespace {

constexpr double kExposure = 0.02;  // [s]
constexpr int kFrames = 60;

SimulationConfig simulation() {
  SimulationConfig config = test::sequenceConfig(kExposure);
  config.trajectory_seed = 3;
  return config;
}

const test::RenderedSequence& sequence() {
  static const test::RenderedSequence sequence = test::renderFrames(simulation(), 0, kFrames);
  return sequence;
}

/// Exposures from 6 to 24 ms and back within 2 s, in equally bright images.
test::RenderedSequence varyingSequence() {
  SimulationConfig config = simulation();
  config.exposure_min = 0.006;
  config.exposure_max = 0.024;
  config.exposure_period = 2.0;
  config.auto_gain = true;
  return test::renderFrames(config, 0, 2 * kFrames);
}

/// Plays the rendered images, telling `exposure`.
class RenderedReader : public SequenceReader {
 public:
  RenderedReader(const test::RenderedSequence& sequence, std::optional<double> exposure)
      : sequence_(sequence), exposure_(exposure) {}
  CameraCalibration calibration() const override { return sequence_.calibration; }
  std::size_t size() const override { return sequence_.frames.size(); }
  std::optional<CameraImage> next() override {
    if (next_ == size()) return std::nullopt;
    const SimulatedFrame& f = sequence_.frames[next_++];
    return CameraImage{f.id, f.mid_exposure_ns, f.mid_exposure_ns, exposure_, f.blurred, "", {}};
  }

 private:
  const test::RenderedSequence& sequence_;
  std::optional<double> exposure_;
  std::size_t next_ = 0;
};

/// The same with nothing to be seen.
class BlankReader : public RenderedReader {
 public:
  using RenderedReader::RenderedReader;
  std::optional<CameraImage> next() override {
    std::optional<CameraImage> image = RenderedReader::next();
    if (image) image->image = cv::Mat(image->image.size(), image->image.type(), cv::Scalar::all(128));
    return image;
  }
};

OfflineResult run(const test::RenderedSequence& sequence, std::optional<double> told, int& announced) {
  OfflineOptions options;
  options.config.mapper.deterministic = true;
  finalize(options.config);
  CalibratedRun run;
  run.open = [&] { return std::make_unique<RenderedReader>(sequence, told); };
  run.progress = [](std::size_t) {};
  run.onRestart = [&](const OfflineResult&) { ++announced; };
  return runCalibrated(run, options);
}

TEST(CalibratedRun, ExposuresThatDidNotComeAreLearntAndTheRunIsBegunAnewWithThem) {
  int announced = 0;
  const OfflineResult result = run(sequence(), std::nullopt, announced);
  EXPECT_EQ(result.restarts, 1);
  EXPECT_EQ(announced, 1);
  ASSERT_TRUE(result.exposure_correction.missing);
  EXPECT_LT(*result.exposure_correction.missing, 1.01 * kExposure);
  EXPECT_GT(*result.exposure_correction.missing, 0.92 * kExposure) << "as short as it may well be, and no shorter";
  ASSERT_EQ(result.log.frames().size(), static_cast<std::size_t>(kFrames));
  EXPECT_EQ(result.log.frames().front().exposure, result.exposure_correction.missing) << "from the first image on";
}

TEST(CalibratedRun, NoOneExposureIsLearntWhereTheyVary) {
  int announced = 0;
  const test::RenderedSequence sequence = varyingSequence();
  const OfflineResult result = run(sequence, std::nullopt, announced);
  EXPECT_TRUE(result.exposure.varies);
  EXPECT_FALSE(result.exposure_correction.missing);
  EXPECT_EQ(result.restarts, 0);
  const std::vector<FrameRecord>& frames = result.log.frames();
  const auto isPublished = [](const FrameRecord& frame) { return frame.online.has_value(); };
  const auto first = std::find_if(frames.begin(), frames.end(), isPublished);
  ASSERT_NE(first, frames.end());
  ASSERT_TRUE(first->exposure) << "known with the first map";
  const double truth = sequence.frames[static_cast<std::size_t>(first - frames.begin())].exposure;
  EXPECT_NEAR(*first->exposure, truth, 0.2 * truth);
}

TEST(CalibratedRun, ExposuresThatAreWrongAreCorrectedFromTheBeginning) {
  int announced = 0;
  const OfflineResult result = run(sequence(), 0.5 * kExposure, announced);
  EXPECT_EQ(result.restarts, 1);
  EXPECT_NEAR(result.exposure_correction.factor, 2.0, 0.2);
  EXPECT_FALSE(result.exposure_correction.missing);
  EXPECT_NEAR(result.log.frames().front().exposure.value(), kExposure, 0.1 * kExposure);
}

TEST(CalibratedRun, WhereNothingIsToBeLearntItRunsOnce) {
  int announced = 0;
  const OfflineResult result = run(sequence(), kExposure, announced);
  EXPECT_EQ(result.restarts, 0);
  EXPECT_EQ(announced, 0);
  EXPECT_EQ(result.exposure_correction, ExposureCorrection());
}

TEST(CalibratedRun, WhatWasLearntIsForgottenWhereNothingCanBeTrackedWithIt) {
  OfflineOptions options;
  options.config.mapper.deterministic = true;
  finalize(options.config);
  int opened = 0;
  int returned = 0;
  CalibratedRun run;
  run.open = [&]() -> std::unique_ptr<SequenceReader> {
    if (++opened == 2) return std::make_unique<BlankReader>(sequence(), std::nullopt);
    return std::make_unique<RenderedReader>(sequence(), std::nullopt);
  };
  run.progress = [](std::size_t) {};
  run.onReturn = [&] { ++returned; };
  const OfflineResult result = runCalibrated(run, options);
  EXPECT_EQ(opened, 3);
  EXPECT_EQ(returned, 1);
  EXPECT_EQ(result.restarts, 2);
  ASSERT_EQ(result.log.frames().size(), static_cast<std::size_t>(kFrames)) << "to the end, whatever is learnt again";
  EXPECT_TRUE(result.log.frames().back().hasPose());
  EXPECT_FALSE(result.log.frames().front().exposure) << "as nobody told it";
}

}  // namespace
}  // namespace mba_vo::calibrated_run_test
