#include "mba_vo/deblur/folder_deblurrer.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "io/temporary_folder.h"

namespace mba_vo::folder_deblurrer_test {
namespace {

using testing::HasSubstr;

constexpr int kWidth = 40;
constexpr int kHeight = 24;

DeblurInput inputOf(std::uint64_t sequence) {
  cv::Mat1f image(kHeight, kWidth, 70.0F);
  image(5, 6) = std::numeric_limits<float>::quiet_NaN();
  DeblurInput input;
  input.image = std::make_shared<const ImagePyramid>(image, PinholeCamera{kWidth, kHeight, 30.0, 30.0, 19.5, 11.5}, 2);
  input.sequence = sequence;
  return input;
}

/// Images numbered 7, as PNG, and 123456, as WebP.
class FolderDeblurrerTest : public testing::Test {
 protected:
  void SetUp() override {
    cv::RNG(3).fill(sharp_, cv::RNG::UNIFORM, 0, 256);
    cv::imwrite(folder_.file("000007.png"), sharp_);
    cv::imwrite(folder_.file("123456.webp"), sharp_, {cv::IMWRITE_WEBP_QUALITY, 101});
    config_.images = folder_.file("");
  }
  cv::Mat1b sharp_ = cv::Mat1b(kHeight, kWidth);
  TemporaryFolder folder_;
  FolderDeblurConfig config_;
};

TEST_F(FolderDeblurrerTest, ReadsTheImageOfTheFrame) {
  for (const std::uint64_t sequence : {7ULL, 123456ULL}) {
    const DeblurInput input = inputOf(sequence);
    const DeblurResult result = FolderDeblurrer(config_).deblur(input);
    ASSERT_TRUE(result.sharpened) << result.reason;
    EXPECT_EQ(result.image->levels(), input.image->levels());
    const cv::Mat1f& image = result.image->level(0).intensity;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        if (x == 6 && y == 5) continue;
        ASSERT_EQ(image(y, x), static_cast<float>(sharp_(y, x))) << x << " " << y;
      }
    }
    EXPECT_TRUE(std::isnan(image(5, 6)));  // what was not seen stays unseen
  }
}

TEST_F(FolderDeblurrerTest, AFrameWithoutAFileIsLeftAsItIs) {
  const DeblurInput input = inputOf(8);
  const DeblurResult result = FolderDeblurrer(config_).deblur(input);
  EXPECT_FALSE(result.sharpened);
  EXPECT_EQ(result.image, input.image);
  EXPECT_EQ(result.reason, "no file");
}

TEST_F(FolderDeblurrerTest, AMissingFolderIsNamed) {
  config_.images = folder_.file("nowhere");
  const std::string message = messageOf([&] { FolderDeblurrer deblurrer(config_); });
  EXPECT_THAT(message, HasSubstr("mapper.deblur.folder.images"));
  EXPECT_THAT(message, HasSubstr("nowhere"));
  EXPECT_THAT(messageOf([&] { FolderDeblurrer deblurrer({}); }), HasSubstr("no folder is given"));
}

TEST_F(FolderDeblurrerTest, AnImageOfAnotherSizeIsNamed) {
  cv::imwrite(folder_.file("000009.png"), cv::Mat1b(8, 8, std::uint8_t{1}));
  const std::string message = messageOf([&] { FolderDeblurrer(config_).deblur(inputOf(9)); });
  EXPECT_THAT(message, HasSubstr("000009.png"));
  EXPECT_THAT(message, HasSubstr("40x24"));
}

}  // namespace
}  // namespace mba_vo::folder_deblurrer_test
