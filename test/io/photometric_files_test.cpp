#include "mba_vo/io/photometric_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "io/temporary_folder.h"

namespace mba_vo {
namespace {

using testing::HasSubstr;

std::string responseText(int count) {
  std::ostringstream text;
  for (int i = 0; i < count; ++i) {
    text << 0.5 * i << " ";
  }
  return text.str();
}

TEST(PhotometricFiles, NoFilesMeanNoCalibration) {
  const PhotometricCalibration calibration = loadPhotometricCalibration("", "");
  EXPECT_TRUE(calibration.inverse_response.empty());
  EXPECT_TRUE(calibration.vignette.empty());
}

TEST(PhotometricFiles, ReadsResponseAndVignetteOfBothDepths) {
  const TemporaryFolder folder;
  for (const int depth : {CV_8U, CV_16U}) {
    const double full = depth == CV_8U ? 250.0 : 60000.0;
    cv::Mat image(4, 6, CV_MAKETYPE(depth, 1), cv::Scalar(full));
    image.row(0).setTo(cv::Scalar(0.4 * full));
    cv::imwrite(folder.file("vignette.png"), image);
    const PhotometricCalibration calibration =
        loadPhotometricCalibration(folder.write("pcalib.txt", responseText(256)), folder.file("vignette.png"));
    ASSERT_EQ(calibration.inverse_response.size(), 256U);
    EXPECT_DOUBLE_EQ(calibration.inverse_response[255], 127.5);
    ASSERT_EQ(calibration.vignette.size(), cv::Size(6, 4));
    EXPECT_FLOAT_EQ(calibration.vignette(0, 3), 0.4F);
    EXPECT_FLOAT_EQ(calibration.vignette(2, 3), 1.0F);
  }
}

TEST(PhotometricFiles, BadFilesAreNamed) {
  const TemporaryFolder folder;
  const auto responseError = [&](const std::string& text) {
    const std::string file = folder.write("pcalib.txt", text);
    return messageOf([&] { loadPhotometricCalibration(file, ""); });
  };
  EXPECT_THAT(messageOf([] { loadPhotometricCalibration("/nonexistent.txt", ""); }), HasSubstr("/nonexistent.txt"));
  EXPECT_THAT(responseError(responseText(255)), HasSubstr("255 values, must be 256"));
  EXPECT_THAT(responseError("0 1 x"), HasSubstr("'x'"));
  EXPECT_THAT(responseError("0 1 1"), HasSubstr("value 2 is 1"));
  const std::string no_image = folder.write("vignette.png", "no image");
  EXPECT_THAT(messageOf([&] { loadPhotometricCalibration("", no_image); }), HasSubstr("vignette.png: not a readable"));
  cv::imwrite(folder.file("black.png"), cv::Mat(4, 6, CV_8UC1, cv::Scalar(0)));
  EXPECT_THAT(messageOf([&] { loadPhotometricCalibration("", folder.file("black.png")); }), HasSubstr("black"));
}

}  // namespace
}  // namespace mba_vo
