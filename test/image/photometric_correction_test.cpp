#include "mba_vo/image/photometric_correction.h"

#include <cmath>
#include <cstdint>
#include <stdexcept>

#include <gtest/gtest.h>

namespace mba_vo::photometric_correction_test {
namespace {

const cv::Size kSize(60, 40);

/// Irradiance of the test scene in linear grey levels.
double irradiance(int x, int y) { return 5.0 + 3.0 * x + 1.5 * y; }

double vignette(int x, int y) {
  const double r2 = (std::pow(x - 29.5, 2) + std::pow(y - 19.5, 2)) / (35.0 * 35.0);
  return 1.0 - 0.5 * r2;
}

/// A camera: what it makes of the scene, `encode` maps linear [0, 255] to code values [0, full_scale].
template <typename Component, typename Encode>
cv::Mat photograph(Encode encode, double full_scale, bool vignetted) {
  cv::Mat_<Component> image(kSize);
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const double light = irradiance(x, y) * (vignetted ? vignette(x, y) : 1.0);
      image(y, x) = static_cast<Component>(std::lround(full_scale * encode(light / 255.0)));
    }
  }
  return image;
}

void expectIrradiance(const cv::Mat1f& linear, double tolerance) {
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) ASSERT_NEAR(linear(y, x), irradiance(x, y), tolerance) << x << ", " << y;
  }
}

double gammaEncode(double light) { return std::pow(light, 1.0 / 2.2); }
double responseEncode(double light) { return std::log(1.0 + 3.0 * light) / std::log(4.0); }

TEST(PhotometricCorrection, LinearEightBitPassesExactly) {
  const PhotometricCorrection correction({}, 1.0, {256, 1});
  cv::Mat1b image(1, 256);
  for (int x = 0; x < 256; ++x) image(0, x) = static_cast<std::uint8_t>(x);
  const cv::Mat1f linear = correction.apply(image);
  for (int x = 0; x < 256; ++x) EXPECT_EQ(linear(0, x), static_cast<float>(x));
}

TEST(PhotometricCorrection, UndoesGamma) {
  const PhotometricCorrection correction({}, 2.2, kSize);
  expectIrradiance(correction.apply(photograph<std::uint8_t>(gammaEncode, 255.0, false)), 1.2);
  expectIrradiance(correction.apply(photograph<std::uint16_t>(gammaEncode, 65535.0, false)), 0.02);
}

TEST(PhotometricCorrection, SixteenBitImagesAreWhiteWhereTold) {
  const PhotometricCorrection correction({}, 2.2, kSize);
  expectIrradiance(correction.apply(photograph<std::uint16_t>(gammaEncode, 4095.0, false), 4095.0), 0.1);
  const cv::Mat1f beyond = correction.apply(cv::Mat1w(kSize, std::uint16_t{5000}), 4095.0);
  EXPECT_EQ(beyond(0, 0), 255.0F);
}

TEST(PhotometricCorrection, UndoesResponseAndVignette) {
  PhotometricCalibration calibration;
  for (int i = 0; i < 256; ++i) {
    // Scale and offset of a response file are arbitrary.
    calibration.inverse_response.push_back(7.0 + 20.0 * (std::pow(4.0, i / 255.0) - 1.0) / 3.0);
  }
  calibration.vignette.create(kSize);
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) calibration.vignette(y, x) = static_cast<float>(vignette(x, y));
  }
  const PhotometricCorrection correction(calibration, 1.0, kSize);
  expectIrradiance(correction.apply(photograph<std::uint8_t>(responseEncode, 255.0, true)), 2.0);
  expectIrradiance(correction.apply(photograph<std::uint16_t>(responseEncode, 65535.0, true)), 0.02);
}

TEST(PhotometricCorrection, MasksPixelsThatSeeNothing) {
  PhotometricCalibration calibration;
  calibration.vignette = cv::Mat1f(kSize, 0.5F);
  calibration.vignette(3, 4) = 0.0F;
  calibration.vignette(5, 6) = 0.001F;
  const cv::Mat1f linear = PhotometricCorrection(calibration, 1.0, kSize).apply(cv::Mat1b(kSize, std::uint8_t{100}));
  EXPECT_TRUE(std::isnan(linear(3, 4)));
  EXPECT_TRUE(std::isnan(linear(5, 6)));
  EXPECT_FLOAT_EQ(linear(4, 4), 200.0F);
}

TEST(PhotometricCorrection, MixesColoursInLinearLight) {
  const PhotometricCorrection correction({}, 2.0, {1, 1});
  const auto linear = [](double code) { return 255.0 * std::pow(code / 255.0, 2.0); };
  const double expected = 0.114 * linear(40) + 0.587 * linear(200) + 0.299 * linear(90);
  EXPECT_NEAR(correction.apply(cv::Mat(1, 1, CV_8UC3, cv::Scalar(40, 200, 90)))(0, 0), expected, 1e-3);
  EXPECT_NEAR(correction.apply(cv::Mat(1, 1, CV_8UC4, cv::Scalar(40, 200, 90, 13)))(0, 0), expected, 1e-3);
  const cv::Mat deep(1, 1, CV_16UC3, cv::Scalar(257 * 40, 257 * 200, 257 * 90));
  EXPECT_NEAR(correction.apply(deep)(0, 0), expected, 1e-3);
}

TEST(PhotometricCorrection, RejectsUnknownTypes) {
  const PhotometricCorrection correction({}, 1.0, kSize);
  EXPECT_THROW(correction.apply(cv::Mat(kSize, CV_32FC1)), std::invalid_argument);
  EXPECT_THROW(correction.apply(cv::Mat(kSize, CV_8UC2)), std::invalid_argument);
}

TEST(PhotometricCorrection, RejectsImpossibleCalibrations) {
  EXPECT_THROW(PhotometricCorrection({}, 0.0, kSize), std::invalid_argument);
  PhotometricCalibration calibration;
  calibration.inverse_response.assign(255, 1.0);
  EXPECT_THROW(PhotometricCorrection(calibration, 1.0, kSize), std::invalid_argument);
  calibration.inverse_response.clear();
  for (int i = 0; i < 256; ++i) calibration.inverse_response.push_back(i);
  EXPECT_NO_THROW(PhotometricCorrection(calibration, 1.0, kSize));
  calibration.inverse_response[100] = 99.0;  // not increasing
  EXPECT_THROW(PhotometricCorrection(calibration, 1.0, kSize), std::invalid_argument);

  PhotometricCalibration vignetted;
  vignetted.vignette = cv::Mat1f(10, 10, 1.0F);
  EXPECT_THROW(PhotometricCorrection(vignetted, 1.0, kSize), std::invalid_argument);
  vignetted.vignette = cv::Mat1f(kSize, 1.5F);
  EXPECT_THROW(PhotometricCorrection(vignetted, 1.0, kSize), std::invalid_argument);
}

}  // namespace
}  // namespace mba_vo::photometric_correction_test
