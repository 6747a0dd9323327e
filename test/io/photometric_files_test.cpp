#include "mba_vo/io/photometric_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "io/temporary_folder.h"

namespace mba_vo::photometric_files_test {
namespace {

using testing::HasSubstr;

std::string responseText(int count) {
  std::ostringstream text;
  for (int i = 0; i < count; ++i) {
    text << 0.5 * i << " ";
  }
  return text.str();
}

PhotometricCalibration vignetteOf(const std::string& file) {
  FrameBuilderConfig config;
  config.vignette_file = file;
  return loadPhotometricCalibration(config);
}

PhotometricCalibration maskOf(const std::string& file) {
  FrameBuilderConfig config;
  config.mask_file = file;
  return loadPhotometricCalibration(config);
}

TEST(PhotometricFiles, NoFilesMeanNoCalibration) {
  const PhotometricCalibration calibration = loadPhotometricCalibration({});
  EXPECT_TRUE(calibration.inverse_response.empty());
  EXPECT_TRUE(calibration.vignette.empty());
  EXPECT_TRUE(calibration.mask.empty());
}

TEST(PhotometricFiles, ReadsResponseAndVignetteOfBothDepths) {
  const TemporaryFolder folder;
  for (const int depth : {CV_8U, CV_16U}) {
    const double full = depth == CV_8U ? 250.0 : 60000.0;
    cv::Mat image(4, 6, CV_MAKETYPE(depth, 1), cv::Scalar(full));
    image.row(0).setTo(cv::Scalar(0.4 * full));
    cv::imwrite(folder.file("vignette.png"), image);
    FrameBuilderConfig config;
    config.response_file = folder.write("pcalib.txt", responseText(256));
    config.vignette_file = folder.file("vignette.png");
    const PhotometricCalibration calibration = loadPhotometricCalibration(config);
    ASSERT_EQ(calibration.inverse_response.size(), 256U);
    EXPECT_DOUBLE_EQ(calibration.inverse_response[255], 127.5);
    ASSERT_EQ(calibration.vignette.size(), cv::Size(6, 4));
    EXPECT_FLOAT_EQ(calibration.vignette(0, 3), 0.4F);
    EXPECT_FLOAT_EQ(calibration.vignette(2, 3), 1.0F);
  }
}

TEST(PhotometricFiles, ReadsTheMask) {
  const TemporaryFolder folder;
  cv::Mat1b image(4, 6, std::uint8_t{255});
  image(1, 2) = 0;
  cv::imwrite(folder.file("mask.png"), image);
  EXPECT_EQ(cv::countNonZero(maskOf(folder.file("mask.png")).mask != image), 0);
}

TEST(PhotometricFiles, BadFilesAreNamed) {
  const TemporaryFolder folder;
  const auto responseError = [&](const std::string& text) {
    FrameBuilderConfig config;
    config.response_file = folder.write("pcalib.txt", text);
    return messageOf([&] { loadPhotometricCalibration(config); });
  };
  FrameBuilderConfig missing;
  missing.response_file = "/nonexistent.txt";
  EXPECT_THAT(messageOf([&] { loadPhotometricCalibration(missing); }), HasSubstr("/nonexistent.txt"));
  EXPECT_THAT(responseError(responseText(255)), HasSubstr("255 values, must be 256"));
  EXPECT_THAT(responseError("0 1 x"), HasSubstr("'x'"));
  EXPECT_THAT(responseError("0 1 1"), HasSubstr("value 2 is 1"));
  const std::string no_image = folder.write("no_image.png", "no image");
  cv::imwrite(folder.file("black.png"), cv::Mat(4, 6, CV_8UC1, cv::Scalar(0)));
  cv::imwrite(folder.file("deep.png"), cv::Mat(4, 6, CV_16UC1, cv::Scalar(1)));
  for (const auto& load : {vignetteOf, maskOf}) {
    EXPECT_THAT(messageOf([&] { load(no_image); }), HasSubstr("no_image.png: not a readable"));
    EXPECT_THAT(messageOf([&] { load(folder.file("black.png")); }), HasSubstr("black"));
  }
  EXPECT_THAT(messageOf([&] { maskOf(folder.file("deep.png")); }), HasSubstr("deep.png: mask of type CV_16UC1, must"));
}

}  // namespace
}  // namespace mba_vo::photometric_files_test
