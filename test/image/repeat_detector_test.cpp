#include "mba_vo/image/repeat_detector.h"

#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace mba_vo::repeat_detector_test {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr double kNoise = 1.0;  // [grey levels]

/// Textures and a bare wall, seen from `shift` px further along.
cv::Mat1f scene(double shift) {
  static const cv::Mat1f texture = [] {
    cv::Mat1f random(kHeight, 2 * kWidth);
    cv::RNG rng(1);
    rng.fill(random, cv::RNG::NORMAL, 0.0, 400.0);
    cv::GaussianBlur(random, random, {}, 3.0);
    random += 120.0F;
    random(cv::Rect(60, 0, 80, kHeight)).setTo(140.0F);
    return random;
  }();
  cv::Mat1f moved;
  const cv::Matx23d way(1.0, 0.0, -shift, 0.0, 1.0, 0.0);
  cv::warpAffine(texture, moved, way, {kWidth, kHeight}, cv::INTER_LINEAR);
  return moved;
}

class RepeatDetectorTest : public testing::Test {
 protected:
  /// Another exposure.
  cv::Mat1b exposed(double shift, double noise = kNoise) {
    cv::Mat1f random(kHeight, kWidth);
    rng_.fill(random, cv::RNG::NORMAL, 0.0, noise);
    random += scene(shift);
    cv::Mat1b image;
    random.convertTo(image, CV_8U);
    return image;
  }
  static cv::Mat compressed(const cv::Mat& image, int quality) {
    std::vector<unsigned char> bytes;
    cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
    return cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
  }
  /// A camera that moves; returns how far it went [px].
  double walk(int images, double step) {
    double shift = 0.0;
    for (int i = 0; i < images; ++i) EXPECT_FALSE(detector_.isRepeat(exposed(shift += step))) << i;
    return shift;
  }

  cv::RNG rng_{2};
  RepeatDetector detector_;
};

TEST_F(RepeatDetectorTest, TheSameBytesAreARepeat) {
  const cv::Mat1b first = exposed(0.0);
  EXPECT_FALSE(detector_.isRepeat(first));
  EXPECT_TRUE(detector_.isRepeat(first.clone()));
  EXPECT_TRUE(detector_.isRepeat(first.clone()));
  EXPECT_FALSE(detector_.isRepeat(exposed(2.0)));
  EXPECT_FALSE(detector_.isRepeat(first)) << "not the one before";
}

TEST_F(RepeatDetectorTest, RemembersWhatItSawThoughTheBufferIsUsedAgain) {
  cv::Mat1b buffer = exposed(0.0);
  EXPECT_FALSE(detector_.isRepeat(buffer));
  exposed(2.0).copyTo(buffer);
  EXPECT_FALSE(detector_.isRepeat(buffer));
}

TEST_F(RepeatDetectorTest, AStandingCamerasFreshImagesAreNone) {
  for (const double noise : {0.4, 1.0, 4.0}) {
    detector_.reset();
    for (int i = 0; i < 100; ++i) EXPECT_FALSE(detector_.isRepeat(exposed(0.0, noise))) << noise << ", " << i;
  }
}

TEST_F(RepeatDetectorTest, NorIfTheyComeCompressed) {
  for (int i = 0; i < 50; ++i) EXPECT_FALSE(detector_.isRepeat(compressed(exposed(0.0), 80))) << i;
}

TEST_F(RepeatDetectorTest, SlowMotionIsNone) { walk(50, 0.05); }

/// As fine as pixels can show: its differences average out over squares, like noise.
TEST_F(RepeatDetectorTest, FineStrongTextureThatSlowsDownIsNone) {
  cv::Mat1f texture(kHeight, 2 * kWidth);
  rng_.fill(texture, cv::RNG::NORMAL, 120.0, 80.0);
  cv::GaussianBlur(texture, texture, {}, 0.6);
  double shift = 0.0;
  for (int i = 0; i < 40; ++i) {
    shift += i % 20 < 10 ? 4.0 : 0.15;
    cv::Mat1f moved;
    cv::warpAffine(texture, moved, cv::Matx23d(1.0, 0.0, -shift, 0.0, 1.0, 0.0), {kWidth, kHeight}, cv::INTER_CUBIC);
    cv::Mat1b image;
    moved.convertTo(image, CV_8U);
    EXPECT_FALSE(detector_.isRepeat(image)) << i;
  }
}

TEST_F(RepeatDetectorTest, ACameraThatStopsIsSoonKnownToStand) {
  const double shift = walk(10, 2.0);
  int repeats = 0;
  for (int i = 0; i < 50; ++i) repeats += detector_.isRepeat(exposed(shift)) ? 1 : 0;
  EXPECT_LE(repeats, 3) << "and they have the right pose";
  const double on = shift + 2.0;
  EXPECT_FALSE(detector_.isRepeat(exposed(on)));
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(detector_.isRepeat(exposed(on))) << "the noise is known by now";
}

TEST_F(RepeatDetectorTest, RecompressionIsARepeat) {
  for (const int quality : {95, 90, 80, 60}) {
    detector_.reset();
    double shift = walk(4, 2.0);
    for (int i = 0; i < 20; ++i) {
      const cv::Mat image = compressed(exposed(shift += 2.0), 90);
      EXPECT_FALSE(detector_.isRepeat(image)) << i;
      EXPECT_TRUE(detector_.isRepeat(compressed(image, quality))) << quality << ", " << i;
    }
  }
}

TEST_F(RepeatDetectorTest, AClockInTheImageIsNotLookedAt) {
  const cv::Rect clock(20, 20, 60, 16);
  cv::Mat1b unused(kHeight, kWidth, std::uint8_t{0});
  unused(clock).setTo(255);
  const auto withTime = [&](const cv::Mat1b& image, int time) {
    cv::Mat1b stamped = image.clone();
    stamped(clock).setTo(time);
    return stamped;
  };
  for (const bool ignored : {false, true}) {
    detector_.reset();
    if (ignored) detector_.ignore(unused);
    const double shift = walk(4, 2.0);
    const cv::Mat1b image = exposed(shift + 2.0);
    EXPECT_FALSE(detector_.isRepeat(withTime(image, 50)));
    EXPECT_EQ(detector_.isRepeat(withTime(image, 90)), ignored);
  }
}

TEST_F(RepeatDetectorTest, InColourToo) {
  const auto coloured = [&](double shift) {
    cv::Mat bgr;
    cv::merge(std::vector<cv::Mat>{exposed(shift), exposed(shift), exposed(shift + 3.0)}, bgr);
    return bgr;
  };
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(detector_.isRepeat(coloured(2.0 * i)));
  const cv::Mat image = coloured(10.0);
  EXPECT_FALSE(detector_.isRepeat(image));
  EXPECT_TRUE(detector_.isRepeat(compressed(image, 95)));
}

TEST_F(RepeatDetectorTest, SixteenBitsAndOtherSizes) {
  cv::Mat deep;
  exposed(0.0).convertTo(deep, CV_16U, 16.0);
  EXPECT_FALSE(detector_.isRepeat(exposed(0.0)));
  EXPECT_FALSE(detector_.isRepeat(deep));
  EXPECT_TRUE(detector_.isRepeat(deep.clone()));
  EXPECT_FALSE(detector_.isRepeat(deep(cv::Rect(0, 0, 100, 100)).clone()));
}

}  // namespace
}  // namespace mba_vo::repeat_detector_test
