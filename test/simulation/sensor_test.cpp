#include "mba_vo/simulation/sensor.h"

#include <gtest/gtest.h>

namespace mba_vo::sensor_test {
namespace {

double deviation(const cv::Mat& image) {
  cv::Scalar mean, sigma;
  cv::meanStdDev(image, mean, sigma);
  return sigma[0];
}

TEST(Sensor, NoiseHasTheDeviationAskedFor) {
  const cv::Mat1f light(480, 752, 100.3F);
  for (const double sigma : {1.0, 2.5}) {
    const cv::Mat1b image = expose(light, {1.0, sigma, 0.0, 1.0}, 3);
    EXPECT_NEAR(deviation(image), std::sqrt(sigma * sigma + 1.0 / 12.0), 0.01);  // with rounding
    EXPECT_NEAR(cv::mean(image)[0], 100.3, 0.02);
  }
}

TEST(Sensor, NoiseIsRepeatableAndDiffersBetweenStreams) {
  const cv::Mat1f light(64, 64, 100.0F);
  const cv::Mat1b first = expose(light, {}, 1);
  EXPECT_EQ(cv::countNonZero(first != expose(light, {}, 1)), 0);
  const cv::Mat1b second = expose(light, {}, 2);
  cv::Mat difference;
  cv::subtract(first, second, difference, cv::noArray(), CV_32F);
  EXPECT_NEAR(deviation(difference), std::sqrt(2.0 * (1.0 + 1.0 / 12.0)), 0.1);  // independent
}

TEST(Sensor, NeighbouringPixelsAreIndependent) {
  const cv::Mat1f light(200, 200, 100.0F);
  cv::Mat1f noise;
  expose(light, {1.0, 5.0, 0.0, 1.0}, 9).convertTo(noise, CV_32F, 1.0, -100.0);
  const cv::Mat1f left = noise.colRange(0, 199).clone();
  const cv::Mat1f right = noise.colRange(1, 200).clone();
  EXPECT_LT(std::abs(left.dot(right) / left.dot(left)), 0.02);
}

TEST(Sensor, GammaVignetteAndSaturation) {
  const cv::Mat1f light(101, 101, 64.0F);
  EXPECT_EQ(expose(light, {2.0, 0.0, 0.0, 1.0}, 0)(50, 50), 128);  // 255 sqrt(64 / 255)
  const cv::Mat1b dark = expose(light, {1.0, 0.0, 0.5, 1.0}, 0);
  EXPECT_EQ(dark(50, 50), 64);
  EXPECT_EQ(dark(0, 0), 32);
  EXPECT_EQ(expose(light, {1.0, 0.0, 0.0, 10.0}, 0)(50, 50), 255);
}

}  // namespace
}  // namespace mba_vo::sensor_test
