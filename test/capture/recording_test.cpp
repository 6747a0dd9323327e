#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "capture/fake_clock.h"
#include "io/temporary_folder.h"
#include "mba_vo/capture/open_camera.h"
#include "mba_vo/capture/recording_player.h"

namespace mba_vo::recording_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::int64_t kTimeout = 100'000'000;  // [ns]

cv::Mat picture(int level) { return cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(level)); }

class RecordingTest : public testing::Test {
 protected:
  std::unique_ptr<CameraSource> open(const std::string& name) {
    settings_.device.path = folder_.file(name);
    return openCamera(settings_, nullptr, clock_);
  }
  std::string errorOnOpen(const std::string& name) {
    return messageOf([&] { open(name); });
  }

  /// Up to `count` images, with the times at which they came.
  void play(CameraSource& camera, std::size_t count) {
    constexpr int kEnough = 1000;  // events
    for (int i = 0; i < kEnough && images_.size() < count; ++i) {
      const CameraEvent event = camera.next(kTimeout);
      if (const auto* image = std::get_if<CapturedImage>(&event)) {
        images_.push_back(*image);
        came_.push_back(clock_->wallNow());
      } else if (const auto* notice = std::get_if<CameraNotice>(&event)) {
        told_ += notice->text + "\n";
      } else if (std::holds_alternative<EndOfRecording>(event)) {
        ended_ = true;
        break;
      }
    }
  }
  std::vector<int> levels() const {
    std::vector<int> levels;
    for (const CapturedImage& image : images_) levels.push_back(10 * cvRound(cv::mean(image.image)[0] / 10));
    return levels;
  }
  /// From the first image on [ms].
  std::vector<std::int64_t> stamps() const {
    std::vector<std::int64_t> stamps;
    for (const CapturedImage& image : images_) {
      stamps.push_back((image.mid_exposure_ns - images_.front().mid_exposure_ns + 500'000) / 1'000'000);
    }
    return stamps;
  }

  void writeVideo(const std::string& name, double rate) {
    cv::VideoWriter writer(folder_.file(name), cv::CAP_OPENCV_MJPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), rate,
                           {64, 48});
    for (const int level : {50, 100, 150}) writer.write(picture(level));
  }

  const TemporaryFolder folder_;
  const std::shared_ptr<FakeClock> clock_ = std::make_shared<FakeClock>();
  CameraSettings settings_;
  std::vector<CapturedImage> images_;
  std::vector<std::int64_t> came_;  // wall clock [ns]
  std::string told_;
  bool ended_ = false;
};

TEST_F(RecordingTest, AVideoIsPlayedAtItsRate) {
  writeVideo("video.avi", 20.0);
  const auto camera = open("video.avi");
  clock_->sleepFor(7'000'000'000);  // nobody listens yet
  const std::int64_t begun = clock_->wallNow();
  play(*camera, 10);
  EXPECT_TRUE(ended_);
  EXPECT_THAT(levels(), ElementsAre(50, 100, 150));
  EXPECT_THAT(stamps(), ElementsAre(0, 50, 100));
  EXPECT_EQ(images_.front().mid_exposure_ns, begun);
  EXPECT_EQ(came_.back(), images_.back().mid_exposure_ns);
  EXPECT_EQ(images_.front().image.type(), CV_8UC1);
  EXPECT_FALSE(images_.front().exposure.has_value());
  EXPECT_THAT(told_, HasSubstr("video 64x48 at 20 Hz"));
}

TEST_F(RecordingTest, AVideoAtAnotherRateAndInColour) {
  writeVideo("video.avi", 20.0);
  settings_.device.format.rate = 10.0;
  settings_.device.color = true;
  play(*open("video.avi"), 10);
  EXPECT_THAT(stamps(), ElementsAre(0, 100, 200));
  EXPECT_EQ(images_.front().image.type(), CV_8UC3);
}

TEST_F(RecordingTest, ALoopGoesOnOneIntervalAfterTheLastImage) {
  writeVideo("video.avi", 20.0);
  settings_.loop = true;
  play(*open("video.avi"), 7);
  EXPECT_FALSE(ended_);
  EXPECT_THAT(levels(), ElementsAre(50, 100, 150, 50, 100, 150, 50));
  EXPECT_THAT(stamps(), ElementsAre(0, 50, 100, 150, 200, 250, 300));
  EXPECT_EQ(came_.back(), images_.back().mid_exposure_ns);  // and not at once
  EXPECT_EQ(images_.back().number, 7U);
}

TEST_F(RecordingTest, AFolderIsPlayedInTheOrderOfTheNumbers) {
  std::filesystem::create_directory(folder_.file("images"));
  for (const int number : {9, 10, 100}) {
    cv::imwrite(folder_.file("images/frame" + std::to_string(number) + ".png"), picture(number));
  }
  folder_.write("images/frame11.png", "no image");
  folder_.write("images/notes.txt", "no image either");
  settings_.device.format.rate = 25.0;
  play(*open("images"), 10);
  EXPECT_THAT(levels(), ElementsAre(10, 10, 100));
  EXPECT_THAT(stamps(), ElementsAre(0, 40, 120));
  EXPECT_EQ(images_.back().number, 4U);
  EXPECT_THAT(told_, HasSubstr("frame11.png: not a readable image"));
}

TEST_F(RecordingTest, ASequenceFolderBringsTimesExposuresAndCalibration) {
  folder_.write("camera.yaml",
                "image_width: 64\nimage_height: 48\ncamera_name: test\n"
                "camera_matrix: {rows: 3, cols: 3, data: [50, 0, 31.5, 0, 50, 23.5, 0, 0, 1]}\n"
                "distortion_model: plumb_bob\ndistortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\n");
  folder_.write("times.txt", "0 100.00 20\n1 100.03 0\n2 100.09 10\n");
  std::filesystem::create_directory(folder_.file("images"));
  for (int i = 0; i < 3; ++i) cv::imwrite(folder_.file("images/00000" + std::to_string(i) + ".png"), picture(50));
  const auto camera = open("");
  EXPECT_EQ(camera->calibrationFile(), folder_.file("camera.yaml"));
  play(*camera, 10);
  EXPECT_THAT(stamps(), ElementsAre(0, 30, 90));
  EXPECT_EQ(images_[0].exposure, 0.02);
  EXPECT_FALSE(images_[1].exposure.has_value());
  EXPECT_EQ(came_[0] - images_[0].mid_exposure_ns, 10'000'000);  // not before the exposure is over
  settings_.camera = "cam1";
  EXPECT_THAT(errorOnOpen(""), HasSubstr("no camera 'cam1' to choose"));
  std::filesystem::remove(folder_.file("camera.yaml"));
  folder_.write("camchain.yaml", "cam1:\n  intrinsics: [50, 50, 31.5, 23.5]\n  resolution: [64, 48]\n");
  EXPECT_EQ(open("")->calibrationFile(), folder_.file("camchain.yaml"));
  settings_.device.format.rate = 10.0;
  EXPECT_THAT(errorOnOpen(""), HasSubstr("rate is 10 Hz"));
  settings_.device.format.rate = 0.0;
  settings_.images = "sharp";
  EXPECT_THAT(errorOnOpen(""), HasSubstr("sharp: no such folder"));
}

/// A disk that takes its time.
class SlowRecording : public Recording {
 public:
  explicit SlowRecording(std::shared_ptr<FakeClock> clock) : clock_(std::move(clock)) {}
  std::optional<RecordedImage> next() override {
    clock_->sleepFor(90'000'000);
    return count_ < 20 ? std::make_optional(RecordedImage{picture(50), 50'000'000 * count_++, {}, ""}) : std::nullopt;
  }
  void rewind() override {}
  std::string description() const override { return "slow"; }

 private:
  std::shared_ptr<FakeClock> clock_;
  std::int64_t count_ = 0;
};

TEST_F(RecordingTest, WhatIsReadTooSlowlyComesLateAndWhole) {
  RecordingPlayer player(std::make_unique<SlowRecording>(clock_), clock_, false, false);
  play(player, 100);
  ASSERT_EQ(images_.size(), 20U);
  EXPECT_EQ(stamps().back(), 19 * 50);  // as it was recorded
  EXPECT_THAT(told_, HasSubstr("s behind"));
}

TEST_F(RecordingTest, WhatCannotBePlayedIsNamed) {
  EXPECT_THAT(errorOnOpen("nothing.mp4"), HasSubstr("nothing.mp4: no such device, file or folder"));
  folder_.write("text.mp4", "no video");
  EXPECT_THAT(errorOnOpen("text.mp4"), HasSubstr("text.mp4: not a video"));
  EXPECT_THAT(errorOnOpen(""), HasSubstr("no images"));
  writeVideo("video.avi", 20.0);
  settings_.device.exposure.seconds = 0.01;
  EXPECT_THAT(errorOnOpen("video.avi"), HasSubstr("exposure of a recording cannot be set"));
  settings_.device.exposure.seconds.reset();
  settings_.device.format.width = settings_.device.format.height = 32;
  EXPECT_THAT(errorOnOpen("video.avi"), HasSubstr("cannot be chosen"));
}

}  // namespace
}  // namespace mba_vo::recording_test
