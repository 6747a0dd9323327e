#include "mba_vo/image/saturation.h"

#include <gtest/gtest.h>

namespace mba_vo::saturation_test {
namespace {

bool isSaturated(int type, const cv::Scalar& value, double white_level = 4095.0) {
  return saturatedPixels(cv::Mat(2, 2, type, value), white_level)(1, 1) != 0;
}

TEST(Saturation, IsNearWhiteInAnyColour) {
  EXPECT_TRUE(isSaturated(CV_8UC1, {254}));
  EXPECT_FALSE(isSaturated(CV_8UC1, {252}));
  EXPECT_TRUE(isSaturated(CV_16UC1, {4090}));
  EXPECT_FALSE(isSaturated(CV_16UC1, {4000}));
  EXPECT_FALSE(isSaturated(CV_16UC1, {4090}, 65535.0));
  EXPECT_TRUE(isSaturated(CV_8UC3, {10, 255, 10}));
  EXPECT_FALSE(isSaturated(CV_8UC4, {10, 10, 10, 255})) << "opacity";
}

}  // namespace
}  // namespace mba_vo::saturation_test
