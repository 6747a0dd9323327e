#include "mba_vo/image/static_overlay.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace mba_vo::static_overlay_test {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr int kImages = 160;
constexpr double kWhite = 255.0;
constexpr double kStep = 6.0;  // [px] from image to image

/// Textures and a bare wall, of which the camera sees a part.
const cv::Mat1f& world() {
  static const cv::Mat1f texture = [] {
    cv::Mat1f random(3 * kHeight, 3 * kWidth);
    cv::RNG rng(1);
    rng.fill(random, cv::RNG::NORMAL, 0.0, 300.0);
    cv::GaussianBlur(random, random, {}, 2.5);
    random += 110.0F;
    random(cv::Rect(300, 200, 200, 300)).setTo(140.0F);
    return random;
  }();
  return texture;
}

/// The light of the scene after a walk of so many images in a curve that does not return soon.
cv::Mat1f scene(int images, double step = kStep) {
  const double way = step * images;
  const double x = kWidth * (1.0 + 0.8 * std::sin(way / 211.0));
  const double y = kHeight * (1.0 + 0.8 * std::sin(way / 157.0 + 0.5));
  cv::Mat1f seen;
  cv::warpAffine(world(), seen, cv::Matx23d(1.0, 0.0, -x, 0.0, 1.0, -y), {kWidth, kHeight}, cv::INTER_LINEAR);
  return seen;
}

cv::Mat1b exposed(const cv::Mat1f& light, double noise, int stream) {
  cv::Mat1f random(light.size());
  cv::RNG rng(static_cast<std::uint64_t>(stream + 1));
  rng.fill(random, cv::RNG::NORMAL, 0.0, noise);
  cv::Mat1b image;
  cv::Mat(light + random).convertTo(image, CV_8U);
  return image;
}

cv::Mat compressed(const cv::Mat& image, int quality) {
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  return cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
}

const cv::Rect kText(20, 10, 120, 20);  // where the watermark is

/// A wall with a poster and a shelf: a tenth of the image.
cv::Mat1f bareRoom() {
  cv::Mat1f light(kHeight, kWidth, 150.0F);
  for (const cv::Rect& place : {cv::Rect(20, 30, 100, 60), cv::Rect(10, 200, 300, 30)}) {
    scene(7)(place).copyTo(light(place));
  }
  return light;
}

/// Share of the light that the watermark lets through is 1 - `opacity`.
void write(cv::Mat1f& light, float opacity) {
  cv::Mat1b text(light.size(), std::uint8_t{0});
  cv::putText(text, "camera 1", {24, 26}, cv::FONT_HERSHEY_SIMPLEX, 0.6, cv::Scalar(255));
  light.forEach([&](float& pixel, const int* at) {
    if (text(at[0], at[1]) > 0) pixel += opacity * (250.0F - pixel);
  });
}

/// Of all pixels outside of `place`, by how much too many are masked.
int maskedOutside(const StaticOverlay& overlay, const cv::Rect& place) {
  cv::Mat1b rest = overlay.pixels().clone();
  rest(place).setTo(0);
  return cv::countNonZero(rest);
}

template <typename Light>
StaticOverlay watch(const Light& light, double noise = 1.0, int images = kImages) {
  StaticOverlay overlay;
  for (int i = 0; i < images; ++i) overlay.add(exposed(light(i), noise, i), kWhite);
  return overlay;
}

TEST(StaticOverlay, FindsAWatermark) {
  for (const float opacity : {1.0F, 0.5F}) {
    const StaticOverlay overlay = watch([&](int i) {
      cv::Mat1f light = scene(i);
      write(light, opacity);
      return light;
    });
    ASSERT_FALSE(overlay.pixels().empty()) << opacity;
    EXPECT_EQ(maskedOutside(overlay, kText), 0) << opacity;
    cv::Mat1f letters(kHeight, kWidth, 0.0F);
    write(letters, 1.0F);
    const cv::Mat1b of_letters(letters > 0.0F);
    const int found = cv::countNonZero(overlay.pixels() & of_letters);
    EXPECT_GT(found, 0.95 * cv::countNonZero(of_letters)) << opacity;
    EXPECT_LT(shareOf(overlay.pixels()), 0.02);
  }
}

TEST(StaticOverlay, FindsDeadAndStuckPixels) {
  cv::Mat1b defects(kHeight, kWidth, std::uint8_t{0});
  cv::RNG rng(3);
  for (int i = 0; i < 20; ++i) defects(rng.uniform(5, kHeight - 5), rng.uniform(5, kWidth - 5)) = 255;
  const StaticOverlay overlay = watch([&](int i) {
    cv::Mat1f light = scene(i);
    light.setTo(i % 2 == 0 ? 254.0F : 252.0F, defects);
    return light;
  });
  ASSERT_FALSE(overlay.pixels().empty());
  EXPECT_EQ(cv::countNonZero(defects & ~overlay.pixels()), 0);
  EXPECT_LT(shareOf(overlay.pixels()), 20 * 25.0 / (kWidth * kHeight));
}

TEST(StaticOverlay, FindsWhatCarriesTheCamera) {
  const cv::Rect bumper(0, kHeight - 40, kWidth, 40);
  const StaticOverlay overlay = watch([&](int i) {
    cv::Mat1f light = scene(i);
    scene(1000)(bumper).copyTo(light(bumper));
    return light;
  });
  ASSERT_FALSE(overlay.pixels().empty());
  EXPECT_EQ(maskedOutside(overlay, cv::Rect(0, kHeight - 42, kWidth, 42)), 0);
  EXPECT_GT(shareOf(overlay.pixels()), 0.1);
}

TEST(StaticOverlay, FindsNothingWhereNothingIs) {
  for (const double step : {0.3, 1.5, kStep, 30.0}) {
    const auto light = [&](int i) { return scene(i, step); };
    EXPECT_TRUE(watch(light, 1.0, 600).pixels().empty()) << step;
  }
}

TEST(StaticOverlay, NothingIsBelievedAfterAFewImages) {
  // A pole that the camera happens to follow for a while.
  const StaticOverlay overlay = watch(
      [](int i) {
        cv::Mat1f light = scene(i);
        if (i < 60) light.colRange(100, 110).setTo(20.0F);
        return light;
      },
      1.0, 90);
  EXPECT_TRUE(overlay.pixels().empty());
}

TEST(StaticOverlay, NeitherDarkCornersNorTheSkyAreMasked) {
  const StaticOverlay overlay = watch([](int i) {
    cv::Mat1f light = scene(i);
    light.rowRange(0, 60 + static_cast<int>(25.0 * std::sin(0.2 * i))).setTo(250.0F);
    light.forEach([](float& pixel, const int* at) {
      const double q = std::pow(at[0] / 120.0 - 1.0, 2) + std::pow(at[1] / 160.0 - 1.0, 2);
      pixel *= static_cast<float>(1.0 - 0.3 * q);
    });
    return light;
  });
  EXPECT_TRUE(overlay.pixels().empty());
}

TEST(StaticOverlay, LearnsNothingWhileTheCameraStands) {
  for (const double noise : {0.3, 2.0, 6.0}) {
    for (const int quality : {100, 75}) {
      StaticOverlay overlay;
      for (int i = 0; i < 2 * kImages; ++i) {
        overlay.add(compressed(exposed(bareRoom(), noise, i), quality), kWhite);
      }
      EXPECT_TRUE(overlay.pixels().empty()) << noise << ", " << quality;
    }
  }
}

TEST(StaticOverlay, NorWhereSomethingMovesBeforeIt) {
  const cv::Rect passer_by(190, 60, 60, 150);
  const StaticOverlay overlay = watch([&](int i) {
    cv::Mat1f light = bareRoom();
    scene(i)(passer_by).copyTo(light(passer_by));
    return light;
  });
  EXPECT_TRUE(overlay.pixels().empty());
}

TEST(StaticOverlay, WhatIsTakenAwayIsForgotten) {
  StaticOverlay overlay;
  bool was_found = false;
  for (int i = 0; i < 4 * kImages; ++i) {
    cv::Mat1f light = scene(i);
    if (i < 2 * kImages) write(light, 1.0F);
    overlay.add(exposed(light, 1.0, i), kWhite);
    was_found = was_found || !overlay.pixels().empty();
  }
  EXPECT_TRUE(was_found);
  EXPECT_TRUE(overlay.pixels().empty());
}

TEST(StaticOverlay, InColourWith16BitsAndOfAnotherSize) {
  StaticOverlay colour, deep;
  for (int i = 0; i < kImages; ++i) {
    cv::Mat1f light = scene(i);
    write(light, 1.0F);
    const cv::Mat1b image = exposed(light, 1.0, i);
    cv::Mat bgr, twelve_bits;
    cv::cvtColor(image, bgr, cv::COLOR_GRAY2BGR);
    image.convertTo(twelve_bits, CV_16U, 16.0);
    colour.add(bgr, kWhite);
    deep.add(twelve_bits, 4095.0);
  }
  EXPECT_FALSE(colour.pixels().empty());
  EXPECT_FALSE(deep.pixels().empty());
  EXPECT_EQ(maskedOutside(colour, kText), 0);
  EXPECT_EQ(maskedOutside(deep, kText), 0);
  bool changed = false;
  for (int i = 0; i < 4; ++i) changed = deep.add(cv::Mat1w(100, 100, std::uint16_t{0}), 4095.0) || changed;
  EXPECT_TRUE(changed);
  EXPECT_TRUE(deep.pixels().empty());
}

}  // namespace
}  // namespace mba_vo::static_overlay_test
