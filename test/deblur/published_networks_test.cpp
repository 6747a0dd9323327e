#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>

#include "deblur/onnx_graph.h"
#include "io/temporary_folder.h"
#include "mba_vo/deblur/onnx_deblurrer.h"

namespace mba_vo::published_networks_test {
namespace {

using testing::HasSubstr;

cv::Mat1f texture(cv::Size size) {
  cv::Mat1f image(size);
  cv::RNG(4).fill(image, cv::RNG::UNIFORM, 20.0, 240.0);
  cv::GaussianBlur(image, image, {0, 0}, 2.0);
  return image;
}

/// Networks as large as these are to be read and run: two sizes of images, any size of network or one.
class PublishedNetworks : public testing::Test {
 protected:
  void SetUp() override { cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT); }

  OnnxDeblurConfig configFor(const std::string& network, int multiple_of) const {
    OnnxDeblurConfig config;
    config.model = folder_.write("network.onnx", network);
    config.multiple_of = multiple_of;
    return config;
  }
  static cv::Mat1f deblurred(const OnnxDeblurConfig& config, const cv::Mat1f& image) {
    const PinholeCamera camera{image.cols, image.rows, 400.0, 400.0, 0.5 * image.cols, 0.5 * image.rows};
    DeblurInput input;
    input.image = std::make_shared<const ImagePyramid>(image, camera, 2);
    const DeblurResult result = OnnxDeblurrer(config).deblur(input);
    EXPECT_TRUE(result.sharpened);
    return result.image->level(0).intensity;
  }
  /// Something was done to the image, but it is still that image.
  static void expectChanged(const cv::Mat1f& image, const cv::Mat1f& result) {
    ASSERT_EQ(result.size(), image.size());
    EXPECT_TRUE(cv::checkRange(result, true, nullptr, 0.0, 255.01));
    const double change = cv::norm(image, result, cv::NORM_L1) / static_cast<double>(image.total());
    EXPECT_GT(change, 0.5);
    EXPECT_LT(change, 60.0);
  }
  static OnnxDeblurConfig fixedTo(OnnxDeblurConfig config, cv::Size size) {
    config.width = size.width;
    config.height = size.height;
    return config;
  }

  TemporaryFolder folder_;
};

constexpr int kVga = 640;
const std::vector<cv::Size> kSizes{{kVga, 480}, {752, 480}};

TEST_F(PublishedNetworks, InTheShapeOfSrn) {
  OnnxDeblurConfig config = configFor(test::srnNetwork(), 16);
  config.mean = 0.0;
  config.scale = 1.0 / 255.0;
  for (const cv::Size size : kSizes) expectChanged(texture(size), deblurred(config, texture(size)));
}

TEST_F(PublishedNetworks, InTheShapeOfDeblurGanWithMobileNet) {
  const OnnxDeblurConfig config = configFor(test::pyramidNetwork(), 32);
  for (const cv::Size size : kSizes) expectChanged(texture(size), deblurred(config, texture(size)));
}

TEST_F(PublishedNetworks, ThoseOfOneSizeAreRunOnTiles) {
  for (const std::string& network : {test::srnNetwork(480, kVga), test::pyramidNetwork(480, kVga)}) {
    const OnnxDeblurConfig any = configFor(network, 32);
    EXPECT_THAT(messageOf([&] { OnnxDeblurrer deblurrer(any); }),
                testing::AllOf(HasSubstr("does not run on an image of 64x64 px"), HasSubstr("width and height")));
    const OnnxDeblurConfig config = fixedTo(any, {kVga, 480});
    for (const cv::Size size : {kSizes[0], kSizes[1], cv::Size(320, 240)}) {
      expectChanged(texture(size), deblurred(config, texture(size)));
    }
    EXPECT_THAT(messageOf([&] { OnnxDeblurrer deblurrer(fixedTo(any, {kVga, 512})); }), HasSubstr("640x512 px"));
  }
}

TEST_F(PublishedNetworks, TilesShowNoSeams) {
  const cv::Mat1f image = texture({752, 480});
  const cv::Mat1f whole = deblurred(configFor(test::srnNetwork(), 16), image);
  const cv::Mat1f tiled = deblurred(fixedTo(configFor(test::srnNetwork(256, 320), 16), {320, 256}), image);
  const cv::Rect inside(0, 0, 752, 464);  // below, the whole image and the tiles are filled up differently
  EXPECT_LT(cv::norm(whole(inside), tiled(inside), cv::NORM_INF), 0.5);
  EXPECT_GT(cv::norm(whole, image, cv::NORM_INF), 8.0) << "or there would be nothing to see";
}

}  // namespace
}  // namespace mba_vo::published_networks_test
