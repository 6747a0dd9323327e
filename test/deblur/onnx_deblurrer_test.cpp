#include "mba_vo/deblur/onnx_deblurrer.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>

#include "deblur/onnx_writer.h"
#include "io/temporary_folder.h"

namespace mba_vo::onnx_deblurrer_test {
namespace {

using testing::HasSubstr;

const std::vector<float> kSame{0, 0, 0, 0, 1, 0, 0, 0, 0};
const std::vector<float> kSharpen{0, -0.5F, 0, -0.5F, 3.0F, -0.5F, 0, -0.5F, 0};

cv::Mat1f texture(int width, int height) {
  cv::Mat1f image(height, width);
  cv::RNG(4).fill(image, cv::RNG::UNIFORM, 60.0, 180.0);
  cv::GaussianBlur(image, image, {0, 0}, 2.0);
  return image;
}

DeblurInput inputOf(const cv::Mat1f& image) {
  const PinholeCamera camera{image.cols, image.rows, 100.0, 100.0, 50.0, 40.0};
  DeblurInput input;
  input.image = std::make_shared<const ImagePyramid>(image, camera, 2);
  return input;
}

class OnnxDeblurrerTest : public testing::Test {
 protected:
  void SetUp() override { cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT); }

  OnnxDeblurConfig configFor(const std::string& network, int channels) const {
    OnnxDeblurConfig config;
    config.model = folder_.write("network.onnx", network);
    config.channels = channels;
    config.gamma = 1.0;
    return config;
  }
  std::string problemWith(const OnnxDeblurConfig& config) const {
    return messageOf([&] { OnnxDeblurrer deblurrer(config); });
  }

  TemporaryFolder folder_;
};

TEST_F(OnnxDeblurrerTest, RunsGreyAndColourNetworksOnAnySize) {
  const cv::Mat1f image = texture(101, 75);  // no multiples of anything
  cv::Mat1f expected;
  cv::filter2D(image, expected, -1, cv::Mat1f(3, 3, const_cast<float*>(kSharpen.data())), {-1, -1}, 0.0,
               cv::BORDER_REFLECT_101);
  for (const int channels : {1, 3}) {
    const auto c = static_cast<std::uint64_t>(channels);
    const OnnxDeblurrer deblurrer(configFor(test::onnxConvolution(c, c, kSharpen), channels));
    const DeblurResult result = deblurrer.deblur(inputOf(image));
    ASSERT_TRUE(result.sharpened);
    EXPECT_EQ(result.image->levels(), 2);
    const cv::Rect inside(2, 2, 97, 71);  // the kernel's own mean is 1: the normalisation cancels
    EXPECT_LT(cv::norm(result.image->level(0).intensity(inside), expected(inside), cv::NORM_INF), 0.01) << channels;
  }
}

TEST_F(OnnxDeblurrerTest, WhatIsAddedToTheInputMayComeOut) {
  OnnxDeblurConfig config = configFor(test::onnxConvolution(1, 1, {0, 0, 0, 0, 0.5F, 0, 0, 0, 0}), 1);
  config.residual = true;
  config.mean = 0.0;
  config.scale = 1.0 / 255.0;
  const cv::Mat1f image = texture(64, 64);
  const DeblurResult result = OnnxDeblurrer(config).deblur(inputOf(image));
  EXPECT_NEAR(result.image->level(0).intensity(30, 30), std::min(255.0F, 1.5F * image(30, 30)), 0.01F);
}

TEST_F(OnnxDeblurrerTest, TheNetworkSeesGammaCodedPictures) {
  OnnxDeblurConfig config = configFor(test::onnxConvolution(1, 1, {0, 0, 0, 0, 0.5F, 0, 0, 0, 0}), 1);
  config.mean = 0.0;
  config.scale = 1.0;
  config.gamma = 2.0;
  cv::Mat1f image = texture(64, 64);
  image(10, 10) = -3.0F;  // noise about black
  const cv::Mat1f result = OnnxDeblurrer(config).deblur(inputOf(image)).image->level(0).intensity;
  EXPECT_NEAR(result(30, 30), 0.25F * image(30, 30), 0.01F);  // half of the root is a quarter of the light
  EXPECT_EQ(result(10, 10), 0.0F);
}

TEST_F(OnnxDeblurrerTest, TellsTheLengthOfTheBlurWhereDepthsAreKnown) {
  const OnnxDeblurrer deblurrer(configFor(test::onnxConvolution(1, 1, kSame), 1));
  DeblurInput input = inputOf(texture(101, 75));
  input.motion.exposure = 0.02;
  input.motion.velocity.x() = 5.0;  // [m/s]: 0.1 m, at 2 m and with 100 px per focal length 5 px
  EXPECT_EQ(deblurrer.deblur(input).blur_px, 0.0F) << "no depth is known";
  for (float x = 0.0F; x <= 100.0F; x += 10.0F) {
    for (float y = 0.0F; y <= 70.0F; y += 10.0F) input.depths.push_back({{x, y}, 0.5F});
  }
  EXPECT_NEAR(deblurrer.deblur(input).blur_px, 5.0F, 0.01F);
}

TEST_F(OnnxDeblurrerTest, InvalidPixelsStayInvalid) {
  cv::Mat1f image = texture(64, 64);
  image(5, 6) = std::numeric_limits<float>::quiet_NaN();
  const DeblurResult result = OnnxDeblurrer(configFor(test::onnxConvolution(1, 1, kSame), 1)).deblur(inputOf(image));
  EXPECT_TRUE(std::isnan(result.image->level(0).intensity(5, 6)));
  EXPECT_NEAR(result.image->level(0).intensity(5, 7), image(5, 7), 0.01F);
}

TEST_F(OnnxDeblurrerTest, WrongFilesAreNamedAtOnce) {
  OnnxDeblurConfig config;
  EXPECT_THAT(problemWith(config), HasSubstr("no file is given"));
  config.model = "/nonexistent.onnx";
  EXPECT_THAT(problemWith(config), HasSubstr("mapper.deblur.onnx.model '/nonexistent.onnx': no such file"));
  EXPECT_THAT(problemWith(configFor("this is no network", 1)), HasSubstr("not an ONNX network that OpenCV can read"));
  EXPECT_THAT(problemWith(configFor(test::onnxNetwork("NoSuchOperator", 1, 1, {}, {}, {}), 1)),
              HasSubstr("not an ONNX network that OpenCV can read"));
  EXPECT_THAT(problemWith(configFor(test::onnxConvolution(1, 1, kSame), 2)),
              HasSubstr("channels is 2, must be 1 or 3"));
}

TEST_F(OnnxDeblurrerTest, WrongShapesAreNamedAtOnce) {
  EXPECT_THAT(problemWith(configFor(test::onnxConvolution(3, 1, kSame), 3)),
              HasSubstr("gives 1x1x64x64 for 1x3x64x64, must be the same"));
  EXPECT_THAT(problemWith(configFor(test::onnxConvolution(3, 3, kSame), 1)),
              HasSubstr("does not run on an image of 64x64 px with 1 channel(s)"));
  OnnxDeblurConfig config = configFor(test::onnxConvolution(1, 1, kSame), 1);
  config.width = 640;
  EXPECT_THAT(problemWith(config), HasSubstr("width is 640 and height 0, must both be"));
}

TEST_F(OnnxDeblurrerTest, IsChosenByTheConfiguration) {
  DeblurConfig config;
  config.method = "onnx";
  config.onnx = configFor(test::onnxConvolution(1, 1, kSame), 1);
  EXPECT_TRUE(makeDeblurrer(config)->deblur(inputOf(texture(64, 64))).sharpened);
  config.onnx.model = "/nonexistent.onnx";
  EXPECT_THROW(makeDeblurrer(config), std::invalid_argument);
}

}  // namespace
}  // namespace mba_vo::onnx_deblurrer_test
