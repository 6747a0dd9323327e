#include "mba_vo/evaluation/image_quality.h"

#include <cmath>
#include <limits>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace mba_vo::image_quality_test {
namespace {

using testing::HasSubstr;

cv::Mat1f texture() {
  cv::Mat1f image(90, 120);
  cv::RNG(4).fill(image, cv::RNG::UNIFORM, 40.0, 200.0);
  cv::GaussianBlur(image, image, {0, 0}, 1.2);
  return image;
}

TEST(ImageQuality, PsnrFollowsItsDefinition) {
  const cv::Mat1f truth = texture();
  EXPECT_NEAR(compareImages(cv::Mat1f(truth + 5.0F), truth).psnr, 20.0 * std::log10(255.0 / 5.0), 1e-3);
}

TEST(ImageQuality, SsimIsOneForEqualImagesAndFallsWithBlur) {
  const cv::Mat1f truth = texture();
  EXPECT_NEAR(compareImages(truth, truth).ssim, 1.0, 1e-6);
  cv::Mat1f little;
  cv::Mat1f much;
  cv::blur(truth, little, {3, 3});
  cv::blur(truth, much, {9, 9});
  const double s1 = compareImages(little, truth).ssim;
  const double s2 = compareImages(much, truth).ssim;
  EXPECT_LT(s1, 0.97);
  EXPECT_LT(s2, s1 - 0.1);
}

/// On constant images only the luminance term is left: (2ab + c) / (a^2 + b^2 + c), c = (0.01 * 255)^2.
TEST(ImageQuality, SsimOfConstantImages) {
  const double c = 6.5025;
  const double expected = (2.0 * 100 * 150 + c) / (100 * 100 + 150 * 150 + c);
  EXPECT_NEAR(compareImages(cv::Mat1f(40, 40, 100.0F), cv::Mat1f(40, 40, 150.0F)).ssim, expected, 1e-4);
}

TEST(ImageQuality, InvalidPixelsDoNotCount) {
  const cv::Mat1f truth = texture();
  cv::Mat1f image(truth + 5.0F);
  image(cv::Rect(10, 10, 20, 20)).setTo(std::numeric_limits<float>::quiet_NaN());
  EXPECT_NEAR(compareImages(image, truth).psnr, 20.0 * std::log10(255.0 / 5.0), 1e-3);
}

TEST(DeblurTable, HasMeansByLengthOfTheBlur) {
  std::vector<DeblurRecord> records(3);
  records[0] = {"000001", 10.0, true, "", 1.1, 200.0, true, {30.0, 0.8}, {34.0, 0.9}};
  records[1] = {"000002", 15.0, true, "", 1.2, 300.0, true, {28.0, 0.7}, {29.0, 0.8}};
  records[2] = {"000003", 1.0, false, "sharp enough", 0.0, 10.0, true, {40.0, 0.99}, {40.0, 0.99}};
  std::ostringstream table;
  writeDeblurTable(records, table);
  EXPECT_THAT(table.str(), HasSubstr("| 8.0 to 20.0 | 2 | 2 | 29.00 | 31.50 | 2.50 | 1.00 | 0.750 | 0.850 | 250 |"));
  EXPECT_THAT(table.str(), HasSubstr("| 0.0 to 4.0 | 1 | 0 | 40.00 | 40.00 | 0.00 |  | 0.990 | 0.990 |  |"));
  std::ostringstream csv;
  writeDeblurRecords(records, csv);
  EXPECT_THAT(csv.str(), HasSubstr("\n000001,10.00,1,,1.100,200.0,30.000,34.000,0.8000,0.9000,,,0.00,0.00,0.00,,,\n"));
}

TEST(DeblurTable, TellsWhatASecondFrameGains) {
  std::vector<DeblurRecord> records(2);
  records[0] = {"000001", 10.0, true, "", 1.1, 500.0, true, {30.0, 0.8}, {36.0, 0.95}};
  records[0].second = -2;
  records[0].second_expected_gain = 2.5;
  records[0].second_shift_px = 0.1;
  records[0].second_residual = 1.2;
  records[0].alone = {33.0, 0.9};
  records[0].milliseconds_alone = 200.0;
  records[1] = {"000002", 15.0, true, "", 1.2, 300.0, true, {28.0, 0.7}, {29.0, 0.8}};
  records[1].second_reason = "blurred alike";
  std::ostringstream table;
  writeSecondFrameTable(records, table);
  EXPECT_THAT(table.str(),
              HasSubstr("| 8.0 to 20.0 | 2 | 2.00 | 3.50 | 1 | 3.00 | 6.00 | 3.00 | 0.900 | 0.950 | 200 | 500 |"));
  std::ostringstream csv;
  writeDeblurRecords(records, csv);
  EXPECT_THAT(csv.str(), HasSubstr(",0.9500,-2,,2.50,0.10,1.20,33.000,0.9000,200.0\n"));
  EXPECT_THAT(csv.str(), HasSubstr(",0.8000,,blurred alike,0.00,0.00,0.00,,,\n"));
}

}  // namespace
}  // namespace mba_vo::image_quality_test
