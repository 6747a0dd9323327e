#include "mba_vo/io/offline_run.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/temporary_folder.h"

namespace mba_vo::offline_run_test {
namespace {

using testing::HasSubstr;

/// Plays given images of a featureless wall, on which nothing can initialise.
class FakeReader : public SequenceReader {
 public:
  CameraCalibration calibration() const override {
    CameraCalibration calibration;
    calibration.width = 64;
    calibration.height = 48;
    calibration.fx = calibration.fy = 60.0;
    calibration.cx = 31.5;
    calibration.cy = 23.5;
    return calibration;
  }
  std::size_t size() const override { return images_.size(); }
  std::optional<CameraImage> next() override {
    return next_ == images_.size() ? std::nullopt : std::optional<CameraImage>(images_[next_++]);
  }
  CameraImage& add(double time, std::optional<double> exposure) {
    const auto stamp = static_cast<std::int64_t>(std::llround(1e9 * time));
    images_.push_back({images_.size(),
                       stamp,
                       stamp,
                       exposure,
                       cv::Mat(48, 64, CV_8UC1, cv::Scalar(50 + 10 * static_cast<double>(images_.size()))),
                       "",
                       {}});
    return images_.back();
  }

 private:
  std::vector<CameraImage> images_;
  std::size_t next_ = 0;
};

OfflineResult runQuietly(SequenceReader& reader, const OfflineOptions& options) {
  return runOffline(reader, options, [](std::size_t) {});
}

TEST(OfflineRun, EveryImageHasOneRecordWhateverIsWrongWithIt) {
  FakeReader reader;
  reader.add(1.00, 0.02);
  reader.add(1.03, std::nullopt);
  reader.add(1.03, 0.02);  // repeats
  reader.add(0.50, 0.02);  // goes backwards
  CameraImage& broken = reader.add(1.06, 0.02);
  broken.image = cv::Mat();
  broken.problem = "000004.png: not a readable image";
  reader.add(1.09, -0.02);
  reader.add(1.12, std::nan(""));
  reader.add(1.15, 0.5);  // longer than the frame interval
  const OfflineResult result = runQuietly(reader, {});
  const auto& frames = result.log.frames();
  ASSERT_EQ(frames.size(), reader.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].sequence, i);
    EXPECT_FALSE(frames[i].hasPose());
  }
  EXPECT_EQ(frames[0].status, "INITIALIZING");
  EXPECT_DOUBLE_EQ(frames[0].exposure.value(), 0.02);
  EXPECT_EQ(frames[2].status, "REJECTED");
  EXPECT_THAT(frames[2].reason, HasSubstr("repeats"));
  EXPECT_EQ(frames[3].status, "REJECTED");
  EXPECT_THAT(frames[3].reason, HasSubstr("before that of the previous image"));
  EXPECT_EQ(frames[4].status, "REJECTED");
  EXPECT_EQ(frames[4].reason, "000004.png: not a readable image");
  for (const std::size_t i : {5, 6, 7}) {
    EXPECT_EQ(frames[i].status, "INITIALIZING");
    EXPECT_FALSE(frames[i].exposure.has_value());
    EXPECT_THAT(frames[i].reason, HasSubstr("treated as unknown"));
  }
}

TEST(OfflineRun, GivenExposureReplacesTheRecordedOne) {
  for (const double exposure : {0.0, 0.015}) {
    FakeReader reader;
    reader.add(1.00, 0.02);
    reader.add(1.03, std::nullopt);
    OfflineOptions options;
    options.exposure = exposure;
    const OfflineResult result = runQuietly(reader, options);
    EXPECT_EQ(result.log.frames()[0].exposure, exposure);
    EXPECT_EQ(result.log.frames()[1].exposure, exposure);
  }
}

TEST(OfflineRun, SkipsImagesAtTheBeginningAndReportsProgress) {
  FakeReader reader;
  for (int i = 0; i < 5; ++i) {
    reader.add(1.0 + 0.03 * i, 0.02);
  }
  OfflineOptions options;
  options.skip = 2;
  std::vector<std::size_t> progress;
  const OfflineResult result = runOffline(reader, options, [&](std::size_t done) { progress.push_back(done); });
  EXPECT_EQ(result.skipped, 2U);
  ASSERT_EQ(result.log.frames().size(), 3U);
  EXPECT_EQ(result.log.frames()[0].sequence, 2U);
  EXPECT_THAT(progress, testing::ElementsAre(1, 2, 3, 4, 5));
}

TEST(OfflineRun, EndsAfterSoManyImages) {
  FakeReader reader;
  for (int i = 0; i < 7; ++i) {
    reader.add(1.0 + 0.03 * i, 0.02);
  }
  OfflineOptions options;
  options.skip = 2;
  options.frames = 3;
  const OfflineResult result = runQuietly(reader, options);
  ASSERT_EQ(result.log.frames().size(), 3U);
  EXPECT_EQ(result.log.frames().front().sequence, 2U);
  EXPECT_EQ(result.log.frames().back().sequence, 4U);
}

TEST(OfflineRun, ImageOfAnotherSizeIsNamed) {
  FakeReader reader;
  reader.add(1.0, 0.02);
  reader.add(1.03, 0.02).image = cv::Mat(20, 20, CV_8UC1, cv::Scalar(0));
  EXPECT_THAT(messageOf([&] { runQuietly(reader, {}); }), testing::AllOf(HasSubstr("image 1: "), HasSubstr("20x20")));
}

TEST(OfflineRun, WrongOptionsAreNamed) {
  FakeReader reader;
  OfflineOptions options;
  options.reference_delay_frames = -1;
  EXPECT_THAT(messageOf([&] { runQuietly(reader, options); }), HasSubstr("reference delay of -1"));
  options.reference_delay_frames = 0;
  options.config.image.response_file = "/nonexistent/pcalib.txt";
  EXPECT_THAT(messageOf([&] { runQuietly(reader, options); }), HasSubstr("/nonexistent/pcalib.txt"));
}

}  // namespace
}  // namespace mba_vo::offline_run_test
