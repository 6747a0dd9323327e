#include "mba_vo/inspection/judgements.h"

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace mba_vo::judgements_test {
namespace {

constexpr std::int64_t kStart = 1'700'000'000'000'000'000;
constexpr std::int64_t kInterval = 40'000'000;  // [ns]

/// A recording that nothing is wrong with.
CameraFacts goodCamera(int images = 100) {
  CameraFacts facts;
  for (int i = 0; i < images; ++i) {
    ImageFacts image;
    image.stamp_ns = kStart + i * kInterval;
    image.size = {640, 480};
    image.encoding = "mono8";
    image.pixels = {0.4, 0.2, 0.01, 2.0};
    facts.images.push_back(image);
    facts.exposures.push_back({image.stamp_ns, 0.01});
  }
  facts.calibration = {640, 480, 500.0, 500.0, 319.5, 239.5, "plumb_bob", {0.0, 0.0, 0.0, 0.0, 0.0}};
  return facts;
}

std::string names(const CameraFacts& facts) {
  std::string text;
  for (const Finding& finding : judge(facts))
    text += (text.empty() ? "" : " ") + std::string(textOf(finding.check).name);
  return text;
}

std::string whatOf(const CameraFacts& facts, Check check) {
  for (const Finding& finding : judge(facts)) {
    if (finding.check == check) return finding.what;
  }
  return "";
}

template <typename Change>
CameraFacts changed(const Change& change) {
  CameraFacts facts = goodCamera();
  change(facts);
  return facts;
}

template <typename Change>
CameraFacts withExposures(const Change& change) {
  return changed([&](CameraFacts& facts) {
    for (std::size_t i = 0; i < facts.exposures.size(); ++i) change(i, facts.exposures[i]);
  });
}

template <typename Change>
CameraFacts withImages(const Change& change) {
  return changed([&](CameraFacts& facts) {
    for (std::size_t i = 0; i < facts.images.size(); ++i) change(i, facts.images[i]);
  });
}

TEST(Judgements, NothingIsSaidOfAGoodRecording) {
  EXPECT_EQ(names(goodCamera()), "");
  EXPECT_EQ(names(CameraFacts{}), "no-exposure");
}

TEST(Judgements, Stamps) {
  const auto of = [](const auto& change) {
    return withImages([&](std::size_t i, ImageFacts& image) { change(i, image.stamp_ns); });
  };
  // Exposures keep the right stamps, so they have none of the images' wrong ones.
  EXPECT_EQ(names(of([](std::size_t i, std::int64_t& stamp) { stamp = i == 5 ? 0 : stamp; })), "stamps-zero");
  EXPECT_EQ(names(of([](std::size_t i, std::int64_t& stamp) { stamp -= i == 5 ? kInterval : 0; })), "stamps-repeated");
  const CameraFacts back = of([](std::size_t i, std::int64_t& stamp) { stamp -= i == 5 ? 3 * kInterval : 0; });
  EXPECT_EQ(names(back), "stamps-backwards");
  EXPECT_NE(whatOf(back, Check::kStampsBackwards).find("1 of 100 images"), std::string::npos);
  EXPECT_NE(whatOf(back, Check::kStampsBackwards).find("80 ms"), std::string::npos);
  CameraFacts restart = goodCamera();
  for (std::size_t i = 50; i < 100; ++i) restart.images[i].stamp_ns = restart.exposures[i].stamp_ns -= 100'000'000'000;
  EXPECT_EQ(names(restart), "clock-restarts");
  CameraFacts gap = goodCamera();
  for (std::size_t i = 50; i < 100; ++i) gap.images[i].stamp_ns = gap.exposures[i].stamp_ns += 10 * kInterval;
  EXPECT_EQ(names(gap), "gaps");
  EXPECT_NE(whatOf(gap, Check::kGaps).find("440 ms at 1.96 s; 10 images"), std::string::npos)
      << whatOf(gap, Check::kGaps);
  EXPECT_EQ(names(goodCamera(10)), "few-images");
}

TEST(Judgements, WithoutAnIntervalNoImageCountsAsMissing) {
  EXPECT_NEAR(usualInterval(goodCamera(2).images), 1e-9 * kInterval, 1e-12);
  CameraFacts three = goodCamera(3);
  const std::int64_t begin = three.images.front().stamp_ns;
  three.images[1].stamp_ns = begin + 500'000'000;
  three.images[2].stamp_ns = begin - 100'000'000;
  EXPECT_EQ(usualInterval(three.images), 0.0);
  EXPECT_NE(whatOf(three, Check::kGaps).find(" 0 images are missing"), std::string::npos)
      << whatOf(three, Check::kGaps);
}

TEST(Judgements, ASingleMissingImageIsNoGap) {
  CameraFacts facts = goodCamera();
  facts.images.erase(facts.images.begin() + 50);
  EXPECT_EQ(names(facts), "");
}

TEST(Judgements, StampsOfArrivalJitter) {
  std::mt19937 random(1);
  std::normal_distribution<double> error(0.0, 0.2 * kInterval);
  CameraFacts facts = goodCamera();
  for (std::size_t i = 0; i < facts.images.size(); ++i) {
    facts.images[i].stamp_ns = facts.exposures[i].stamp_ns += static_cast<std::int64_t>(error(random));
  }
  EXPECT_EQ(names(facts), "stamps-jitter");
}

TEST(Judgements, ExposuresInAnotherUnitAreNamedWithTheUnit) {
  for (const auto& [factor, unit] : std::vector<std::pair<double, std::string>>{
           {1e3, "milliseconds"}, {1e6, "microseconds"}, {1e9, "nanoseconds"}}) {
    for (const double exposure : {1e-3, 10e-3, 39e-3}) {
      const CameraFacts facts = withExposures([&](std::size_t, ExposureFacts& e) { e.seconds = factor * exposure; });
      EXPECT_EQ(names(facts), "exposure-unit") << factor << " " << exposure;
      EXPECT_NE(whatOf(facts, Check::kExposureUnit).find(unit), std::string::npos)
          << whatOf(facts, Check::kExposureUnit);
    }
  }
}

TEST(Judgements, Exposures) {
  const auto of = [](const auto& change) {
    return names(withExposures([&](std::size_t i, ExposureFacts& e) { change(i, e.seconds); }));
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(of([](std::size_t, double& s) { s *= 1e-3; }), "exposure-too-short");
  EXPECT_EQ(of([](std::size_t, double& s) { s = 0.08; }), "exposure-too-long");
  EXPECT_EQ(of([](std::size_t i, double& s) { s = i % 3 == 0 ? -s : s; }), "exposure-invalid");
  EXPECT_EQ(of([&](std::size_t i, double& s) { s = i % 3 == 0 ? nan : s; }), "exposure-unknown");
  EXPECT_EQ(of([&](std::size_t, double& s) { s = nan; }), "no-exposure");
  EXPECT_EQ(of([](std::size_t, double& s) { s = 0.0; }), "exposure-zero");
  const CameraFacts late = withExposures([](std::size_t, ExposureFacts& e) { e.stamp_ns += 7'000'000; });
  EXPECT_EQ(names(late), "exposure-unmatched");
  EXPECT_NE(whatOf(late, Check::kExposureUnmatched).find("7 ms"), std::string::npos);
}

TEST(Judgements, WhatImagesShow) {
  const auto of = [](const PixelFacts& pixels, std::size_t every) {
    return names(withImages([&](std::size_t i, ImageFacts& image) {
      if (i % every == 0) image.pixels = pixels;
    }));
  };
  EXPECT_EQ(of({0.002, 0.001, 0.0, 0.0}, 10), "black-images");
  EXPECT_EQ(of({0.9, 0.1, 0.6, 2.0}, 5), "over-exposed");
  EXPECT_EQ(of({0.9, 0.1, 0.6, 2.0}, 20), "");  // past a window now and then
  EXPECT_EQ(of({0.3, 0.005, 0.0, 0.1}, 10), "flat-images");
  EXPECT_EQ(of({0.03, 0.02, 0.0, 2.0}, 1), "dark-images");
  EXPECT_EQ(of({0.4, 0.2, 0.01, 0.1}, 1), "never-sharp");
  const auto moving = [](double length) {
    return names(withImages([&](std::size_t, ImageFacts& image) {
      image.motion = MotionFacts();
      image.motion->length = length;  // the exposure is a quarter of the interval
    }));
  };
  EXPECT_EQ(moving(30.0), "");
  EXPECT_EQ(moving(60.0), "much-blur");
}

TEST(Judgements, WhatCannotBeReadIsCounted) {
  const auto unreadable = [](bool encoding) {
    return withImages([&](std::size_t i, ImageFacts& image) {
      if (i % 4 != 0) return;
      image.problem = "the reason";
      image.size = {};
      image.bad_encoding = encoding;
    });
  };
  EXPECT_EQ(names(unreadable(true)), "image-encoding");
  EXPECT_EQ(names(unreadable(false)), "image-damaged");
  EXPECT_EQ(whatOf(unreadable(false), Check::kImageDamaged),
            "25 of 100 images cannot be read, the first because: the reason");
}

TEST(Judgements, CalibrationAgainstImages) {
  const auto of = [](const auto& change) { return changed([&](CameraFacts& facts) { change(*facts.calibration); }); };
  const CameraFacts scaled = of([](CameraCalibration& c) { c = {1280, 960, 1000.0, 1000.0, 639.5, 479.5, "", {}}; });
  EXPECT_EQ(names(scaled), "camera-info-size");
  EXPECT_NE(whatOf(scaled, Check::kCameraInfoSize).find("scaled by 0.5"), std::string::npos);
  EXPECT_EQ(names(of([](CameraCalibration& c) { c.distortion_model = "barrel"; })), "bad-camera-info");
  EXPECT_EQ(names(of([](CameraCalibration& c) { c.fx = c.fy = 50.0; })), "odd-calibration");
  EXPECT_EQ(names(of([](CameraCalibration& c) { c.fy = 300.0; })), "odd-calibration");
  EXPECT_EQ(names(of([](CameraCalibration& c) { c.cx = 20.0; })), "odd-calibration");
  EXPECT_EQ(names(withImages([](std::size_t i, ImageFacts& image) {
              if (i > 60) image.size = {320, 240};
            })),
            "image-size-changes");
}

TEST(Judgements, GammaIsMeasuredOrNotKnown) {
  const auto camera = [](double power, double change) {
    return changed([&](CameraFacts& facts) {
      for (std::size_t i = 0; i < facts.images.size(); ++i) {
        facts.exposures[i].seconds *= i % 2 == 0 ? 1.0 : std::exp(change);
        facts.images[i].motion = MotionFacts();
        facts.images[i].motion->brighter = (i % 2 == 0 ? -1.0 : 1.0) * power * change + (i % 3 == 0 ? 1e-3 : -1e-3);
      }
      facts.jpeg = true;
    });
  };
  EXPECT_EQ(names(camera(1.0, 0.2)), "") << "linear, though it is JPEG";
  EXPECT_NE(whatOf(camera(1.0 / 2.2, 0.2), Check::kGamma).find("a gamma of 2.2"), std::string::npos);
  for (const CameraFacts& unknown : {camera(0.5, 0.0), camera(0.0, 0.2)}) {  // the same exposures; automatic gain
    EXPECT_NE(whatOf(unknown, Check::kGamma).find("not known"), std::string::npos);
  }
  CameraFacts known = camera(0.5, 0.2);
  known.response_known = true;
  EXPECT_EQ(names(known), "");
}

/// Motion of a shaken camera whose rows are `row_time` apart, and some shear by depths that goes with the velocity.
std::vector<ImageFacts> shakenImages(double row_time) {
  std::vector<ImageFacts> images = goodCamera(200).images;
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 1.0);
  const double dt = 1e-9 * kInterval;
  std::vector<cv::Point2d> velocity{{0.0, 0.0}};  // at each image [px / s]
  for (std::size_t i = 1; i < images.size(); ++i) {
    velocity.emplace_back(0.8 * velocity.back().x + 100.0 * noise(random),
                          0.8 * velocity.back().y + 60.0 * noise(random));
    MotionFacts motion;
    motion.flow = 0.5 * dt * (velocity[i] + velocity[i - 1]);
    const cv::Point2d change = velocity[i] - velocity[i - 1];
    motion.shear_x = row_time * change.x + 0.02 * motion.flow.x / 480.0 + 5e-4 * noise(random);
    motion.shear_y = row_time * change.y + 0.02 * motion.flow.y / 480.0 + 5e-4 * noise(random);
    images[i].motion = motion;
  }
  return images;
}

TEST(Judgements, TheShearOfChangingMotionTellsTheRowTime) {
  for (const double row_time : {0.0, 30e-6, -30e-6}) {
    const auto guess = guessRowTime(shakenImages(row_time));
    ASSERT_TRUE(guess.has_value());
    EXPECT_NEAR(guess->seconds, row_time, 0.3 * std::abs(row_time) + 3.0 * guess->sigma);
    CameraFacts facts = goodCamera(200);
    facts.images = shakenImages(row_time);
    EXPECT_EQ(names(facts), row_time == 0.0 ? "" : "rolling-shutter");
  }
  EXPECT_FALSE(guessRowTime(goodCamera().images).has_value());  // nothing moves
}

}  // namespace
}  // namespace mba_vo::judgements_test
