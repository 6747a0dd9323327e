#include <gtest/gtest.h>

#include "mba_vo/odometry/config_yaml.h"
#include "mba_vo/odometry/odometry.h"
#include "support/rendered_sequence.h"

namespace mba_vo::calibration_test {
namespace {

constexpr double kExposure = 0.02;   // [s]
constexpr double kRowTime = 1.2e-4;  // [s] all rows in 29 ms of the 37 ms between frames
constexpr int kFrames = 110;

using Correction = CalibrationCorrection;

SimulationConfig config() {
  SimulationConfig config = test::sequenceConfig(kExposure);
  config.trajectory_seed = 3;
  return config;
}

/// The correction after running over the frames, begun with `start`, as a user's program would. `row_time`: as told
/// [s].
Correction runOnce(const test::RenderedSequence& sequence, const CameraCalibration& calibration,
                   const Correction& start, double row_time = 0.0) {
  OdometryConfig options;
  options.mapper.deterministic = true;
  finalize(options);
  Odometry odometry(options, 0);
  FrameBuilderConfig images;
  images.row_time = row_time;
  FrameBuilder builder(calibration, {}, images);
  builder.correct(start);
  for (const SimulatedFrame& f : sequence.frames) {
    odometry.process(builder.build(f.blurred, f.id, f.mid_exposure_ns, f.mid_exposure_ns, kExposure));
    builder.correct(*odometry.mapper().correction());
  }
  return *odometry.mapper().correction();
}

Correction run(const test::RenderedSequence& sequence, const CameraCalibration& calibration, int passes) {
  Correction correction;
  for (int pass = 0; pass < passes; ++pass) correction = runOnce(sequence, calibration, correction);
  return correction;
}

/// How far the corrected camera sees a point from where it is, at most over the image [px].
double largestError(const Correction& found, const Correction& truth, const CameraCalibration& c) {
  double largest = 0.0;
  for (int x = 0; x < c.width; x += 15) {
    for (int y = 0; y < c.height; y += 15) {
      const Eigen::Vector2d ray((x - c.cx) / c.fx, (y - c.cy) / c.fy);
      largest = std::max(largest, c.fx * (found.apply(ray) - truth.apply(ray)).norm());
    }
  }
  return largest;
}

TEST(Calibration, ARightOneIsLeftAlone) {
  const test::RenderedSequence sequence = test::renderFrames(config(), 0, kFrames);
  EXPECT_TRUE(runOnce(sequence, sequence.calibration, {}).isZero());
}

TEST(Calibration, AWrongLensIsFound) {
  const test::RenderedSequence sequence = test::renderFrames(config(), 0, kFrames);
  CameraCalibration wrong = sequence.calibration;
  wrong.fx *= 1.015;
  wrong.fy *= 1.015;
  wrong.cx += 4.0;
  Correction truth;
  truth.values.head<2>() << 1.0 / 1.015 - 1.0, -4.0 / wrong.fx;
  const double before = largestError({}, truth, wrong);
  const Correction found = run(sequence, wrong, 2);
  EXPECT_LT(largestError(found, truth, wrong), 0.4 * before) << found.values.transpose();
}

TEST(Calibration, ARollingShutterIsFound) {
  SimulationConfig rolling = config();
  rolling.row_time = kRowTime;
  const test::RenderedSequence sequence = test::renderFrames(rolling, 0, kFrames);
  const Correction found = run(sequence, sequence.calibration, 2);
  const double readout = kRowTime * sequence.calibration.height;
  EXPECT_NEAR(found[Correction::kReadout], readout, 0.1 * readout) << found.values.transpose();
}

// The velocities of the keyframes, not the calibration, are what is not known well enough.
TEST(Calibration, ARollingShutterThatIsToldIsLeftAlone) {
  SimulationConfig rolling = config();
  rolling.row_time = kRowTime;
  const test::RenderedSequence sequence = test::renderFrames(rolling, 0, kFrames);
  const Correction found = runOnce(sequence, sequence.calibration, {}, kRowTime);
  EXPECT_LT(std::abs(found[Correction::kReadout]), 0.02 * kRowTime * sequence.calibration.height)
      << found.values.transpose();
  EXPECT_LT(largestError(found, {}, sequence.calibration), 0.3) << found.values.transpose();
}

TEST(Calibration, AVignetteIsFoundInOnePass) {
  SimulationConfig dark_corners = config();
  dark_corners.vignette = 0.35;
  const test::RenderedSequence sequence = test::renderFrames(dark_corners, 0, kFrames);
  const Correction found = runOnce(sequence, sequence.calibration, {});
  for (const double q : {0.25, 0.5, 0.75}) {  // squared radius, that of the corners being 1
    const double log_light = found.vignette().dot(Correction::Vignette(q, q * q, q * q * q));
    EXPECT_NEAR(log_light, std::log(1.0 - 0.35 * q), 0.02) << found.values.transpose();
  }
  EXPECT_LT(largestError(found, {}, sequence.calibration), 0.5) << found.values.transpose();
}

}  // namespace
}  // namespace mba_vo::calibration_test
