#include "mba_vo/image/depth_image.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

namespace mba_vo::depth_image_test {
namespace {

TEST(DepthImage, IntegersAreUnitsAndZeroIsUnknown) {
  cv::Mat1w units(2, 2, static_cast<std::uint16_t>(0));
  units(0, 1) = 5000;
  units(1, 0) = 65535;
  const cv::Mat1f tum = depthInMetres(units, kTumDepthUnits);
  EXPECT_TRUE(std::isnan(tum(0, 0)));
  EXPECT_FLOAT_EQ(tum(0, 1), 1.0F);
  EXPECT_FLOAT_EQ(tum(1, 0), 13.107F);
  EXPECT_FLOAT_EQ(depthInMetres(units, kMillimetres)(0, 1), 5.0F);
}

TEST(DepthImage, FloatsAreMetres) {
  cv::Mat1f metres(1, 5, 2.5F);
  metres(0, 1) = 0.0F;
  metres(0, 2) = -1.0F;
  metres(0, 3) = std::numeric_limits<float>::infinity();  // REP-118: too far away
  metres(0, 4) = std::nanf("");
  const cv::Mat1f depth = depthInMetres(metres, kMillimetres);
  EXPECT_EQ(depth(0, 0), 2.5F);
  for (int i = 1; i < 5; ++i) EXPECT_TRUE(std::isnan(depth(0, i))) << i;
  metres(0, 0) = 7.0F;
  EXPECT_EQ(depth(0, 0), 2.5F);  // a copy
}

TEST(DepthImage, OtherTypesAreNamed) {
  for (const int type : {CV_8UC1, CV_16SC1, CV_16UC3, CV_64FC1}) {
    try {
      depthInMetres(cv::Mat(4, 4, type), kMillimetres);
      ADD_FAILURE() << type;
    } catch (const std::invalid_argument& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find(cv::typeToString(type)), std::string::npos) << message;
      EXPECT_NE(message.find("16UC1"), std::string::npos) << message;
    }
  }
}

}  // namespace
}  // namespace mba_vo::depth_image_test
