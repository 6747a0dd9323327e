#include "mba_vo/io/calibration_report.h"

#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "io/temporary_folder.h"
#include "mba_vo/image/corrected_calibration.h"
#include "mba_vo/io/camera_file.h"
#include "mba_vo/io/camera_memory.h"
#include "mba_vo/io/camera_yaml.h"
#include "mba_vo/odometry/config_yaml.h"
#include "support/rendered_sequence.h"

namespace mba_vo::calibration_report_test {
namespace {

using testing::HasSubstr;
using Correction = CalibrationCorrection;

CameraCalibration distorted() { return {640, 480, 460.1, 461.2, 322.3, 238.4, "plumb_bob", {-0.2, 0.05, 0, 0, 0}}; }

CalibrationStudy studied() {
  CalibrationEstimate estimate;
  estimate.correction.values << 0.01, -0.004, 0.003, -0.01, 0.002, 480 * 5e-6, -0.2, -0.1, -0.05;
  estimate.covariance = 1e-8 * Correction::Matrix::Identity();
  estimate.windows = 30;
  CalibrationStudy study;
  study.estimate = estimate;
  study.growth = {estimate};
  study.last.correction = estimate.correction;
  study.last.overlay = cv::Mat1b(480, 640, std::uint8_t{0});
  study.last.overlay(3, 4) = 255;
  return study;
}

TEST(CameraYaml, WhatIsWrittenIsRead) {
  const TemporaryFolder folder;
  CameraCalibration camera = distorted();
  camera.fx = 460.0 / 3.0;
  std::ostringstream text;
  writeCameraYaml(camera, "mine", text);
  const CameraCalibration read = readCameraFile(folder.write("camera.yaml", text.str())).calibration;
  EXPECT_EQ(read.fx, camera.fx);
  EXPECT_EQ(read.fy, camera.fy);
  EXPECT_EQ(read.cy, camera.cy);
  EXPECT_EQ(read.height, camera.height);
  EXPECT_EQ(read.distortion, camera.distortion);
  EXPECT_THAT(text.str(), HasSubstr("camera_name: mine"));
}

TEST(CalibrationReport, CameraAndSensorFileBelongTogether) {
  const TemporaryFolder folder;
  const ToldCamera told{distorted(), {}};
  const CalibrationStudy study = studied();
  ToldCamera another = told;
  another.calibration.fx += 1.0;
  writeCalibration(folder.file("out"), another, study);
  writeCalibration(folder.file("out"), told, study);  // over files of an earlier time, too
  const CameraCalibration camera = readCameraFile(folder.file("out/camera.yaml")).calibration;
  const Eigen::Vector2d x = study.estimate.correction.apply({0.3, -0.2});
  const cv::Point2d wanted = projectRays(told.calibration, {{x.x(), x.y(), 1.0}}).front();
  const cv::Point2d seen = projectRays(camera, {{0.3, -0.2, 1.0}}).front();
  EXPECT_NEAR(seen.x, wanted.x, 0.3);
  EXPECT_NEAR(seen.y, wanted.y, 0.3);
  FrameBuilderConfig image;
  image.learnt_file = folder.file("out/sensor.yaml");
  const Correction known = CameraMemory(image).recall(camera);
  EXPECT_FALSE(known.correctsLens()) << "camera.yaml has it";
  EXPECT_EQ(known[Correction::kReadout], 480 * 5e-6);
  EXPECT_EQ(known.vignette(), study.estimate.correction.vignette());
  EXPECT_EQ(cv::imread(folder.file("out/mask.png"), cv::IMREAD_GRAYSCALE).at<std::uint8_t>(3, 4), 0);
  EXPECT_THAT(folder.read("out/calibration.yaml"), HasSubstr("windows: 30"));
}

TEST(CalibrationReport, AFullDiskIsNamed) {
  const TemporaryFolder folder;
  folder.write("out/calibration.yaml", "");
  std::filesystem::create_symlink("/dev/full", folder.file("out/mask.png"));
  EXPECT_EQ(messageOf([&] {
              writeCalibration(folder.file("out"), {distorted(), {}}, studied());
            }),
            folder.file("out/mask.png") + ": cannot be written: No space left on device");
}

TEST(CalibrationReport, NumbersAreInTheUnitsOfTheCamera) {
  const std::vector<CalibratedNumber> numbers = calibratedNumbers({distorted(), {}}, studied().estimate);
  ASSERT_EQ(numbers.size(), 7U);
  EXPECT_NEAR(numbers[0].found, 460.1 * 1.01, 1e-9);
  EXPECT_NEAR(numbers[0].sigma, 460.1 * 1e-4, 1e-9);
  EXPECT_NEAR(numbers[0].significance(), 100.0, 1e-6);
  EXPECT_NEAR(numbers[1].found, 322.3 - 0.004 * 460.1, 1e-9);
  EXPECT_NEAR(numbers[5].found, 5.0, 1e-9);
  EXPECT_NEAR(numbers[6].found, 100.0 * std::exp(-0.35), 1e-9);
  FrameBuilderConfig told_vignette;
  told_vignette.vignette_file = "vignette.png";
  EXPECT_EQ(calibratedNumbers({distorted(), told_vignette}, studied().estimate).size(), 6U);
}

TEST(CalibrationReport, ExposuresThatCameHaveAFactorAndOthersALength) {
  OfflineResult result;
  EXPECT_FALSE(calibratedExposure(result)) << "nothing is known";
  result.exposure.ratio = 1.02;
  result.exposure.log_sigma = 0.03;
  result.exposure_correction.missing = 0.01;  // of a single image
  EXPECT_NEAR(calibratedExposure(result)->found, 1.02, 1e-9);
  result.exposure.used = true;
  EXPECT_NEAR(calibratedExposure(result)->found, 10.0, 1e-9);
  EXPECT_EQ(calibratedExposure(result)->unit, "ms");
  result.exposure_correction.factor = 1.5;
  EXPECT_NEAR(calibratedExposure(result)->found, 1.5, 1e-9);
  EXPECT_NEAR(calibratedExposure(result)->sigma, 0.045, 1e-9);
  result.exposure.varies = true;
  EXPECT_FALSE(calibratedExposure(result)) << "no number is right for all";
}

/// Plays rendered images, told a focal length that is wrong.
class WronglyToldReader : public SequenceReader {
 public:
  static constexpr double kFactor = 1.03;
  static constexpr double kExposure = 0.02;  // [s]

  static const test::RenderedSequence& sequence() {
    static const test::RenderedSequence rendered = [] {
      SimulationConfig config = test::sequenceConfig(kExposure);
      config.trajectory_seed = 3;
      return test::renderFrames(config, 0, 110);
    }();
    return rendered;
  }
  CameraCalibration calibration() const override {
    CameraCalibration wrong = sequence().calibration;
    wrong.fx *= kFactor;
    wrong.fy *= kFactor;
    return wrong;
  }
  std::size_t size() const override { return sequence().frames.size(); }
  std::optional<CameraImage> next() override {
    if (next_ == size()) return std::nullopt;
    const SimulatedFrame& f = sequence().frames[next_++];
    return CameraImage{f.id, f.mid_exposure_ns, f.mid_exposure_ns, kExposure, f.blurred, "", {}};
  }

 private:
  std::size_t next_ = 0;
};

TEST(CalibrationPasses, TheFocalLengthIsFoundAsSurelyAsItSays) {
  OfflineOptions options;
  options.config.mapper.deterministic = true;
  finalize(options.config);
  CalibratedRun run;
  run.open = [] { return std::make_unique<WronglyToldReader>(); };
  run.progress = [](std::size_t) {};
  const CalibrationStudy study = studyCalibration(run, options, 4);
  const ToldCamera told{WronglyToldReader().calibration(), options.config.image};
  const CalibratedNumber focal = calibratedNumbers(told, study.estimate).front();
  const double truth = WronglyToldReader::sequence().calibration.fx;
  EXPECT_LT(std::abs(focal.found - truth), 0.3 * std::abs(focal.told - truth));
  EXPECT_LT(std::abs(focal.found - truth), 3.0 * focal.sigma) << focal.found << " +- " << focal.sigma;
  EXPECT_LT(focal.sigma, std::abs(focal.told - truth));
  EXPECT_EQ(study.growth.size(), study.last.log.keyframes().size());
}

TEST(CalibrationPasses, WhatNoStepWasTakenForStaysAsTold) {
  CalibrationStudy study = studied();
  EXPECT_EQ(study.correction(), study.estimate.correction);
  study.last.correction.values(Correction::kReadout) = 0.0;
  study.last.correction.values.tail<3>().setZero();
  EXPECT_EQ(study.correction()[Correction::kReadout], 0.0);
  EXPECT_FALSE(study.correction().correctsVignette());
  EXPECT_EQ(study.correction()[Correction::kFocal], study.estimate.correction[Correction::kFocal]);
  study.last.correction = {};
  EXPECT_TRUE(study.correction().isZero());
}

TEST(CalibrationPasses, SaysThatNothingWouldBeLearnt) {
  OfflineOptions options;
  options.config.mapper.refine_calibration = false;
  EXPECT_THAT(messageOf([&] { studyCalibration({}, options, 2); }), HasSubstr("'mapper.refine_calibration' is false"));
}

}  // namespace
}  // namespace mba_vo::calibration_report_test
