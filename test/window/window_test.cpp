#include "mba_vo/window/window.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "support/random.h"
#include "window/planar_views.h"

namespace mba_vo::window_test {
namespace {

using test::Disturbance;
using test::fill;
using test::keyframesOf;
using test::kFrames;
using test::views;

double largestPositionError(const Window& window) {
  std::vector<SE3> estimate;
  for (const KeyframeId id : window.keyframes()) estimate.push_back(window.T_map_keyframe(id));
  const std::vector<double> errors = test::alignedPositionErrors(views().truth, estimate);
  return *std::max_element(errors.begin(), errors.end());
}

double medianDepthError(const Window& window) {
  const test::Views& v = views();
  std::vector<double> ratios;
  for (const WindowPoint& p : window.points()) {
    ratios.push_back(p.inverse_depth / v.scene.inverseDepth(v.camera, v.truth[p.host], p.pixel));
  }
  const auto median = [](std::vector<double>& x) {
    std::nth_element(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2), x.end());
    return x[x.size() / 2];
  };
  const double scale = median(ratios);
  for (double& r : ratios) r = std::abs(r / scale - 1.0);
  return median(ratios);
}

TEST(Window, RecoversPosesAndDepthsFromSharpImages) {
  Window window{WindowConfig()};
  fill(window, keyframesOf(views().sharp, views().sharp, false), Disturbance());
  ASSERT_GT(largestPositionError(window), 0.02);
  const WindowSummary summary = window.optimize(20);
  EXPECT_LT(summary.final_cost, 0.02 * summary.initial_cost);
  EXPECT_LT(largestPositionError(window), 1e-3);
  EXPECT_LT(medianDepthError(window), 2e-3);
  EXPECT_LT(summary.rms, 1.0);
  // Gauge: the first pose did not move.
  EXPECT_LT((views().truth[0].inverse() * window.T_map_keyframe(0)).log().norm(), 1e-5);
}

TEST(Window, EndsWithTheIterationThatGainsTooLittle) {
  const auto optimized = [](double min_relative_decrease) {
    WindowConfig config;
    config.min_relative_decrease = min_relative_decrease;
    Window window(config);
    fill(window, keyframesOf(views().sharp, views().sharp, false), Disturbance());
    return window.optimize(20);
  };
  const WindowSummary all = optimized(0.0);
  const WindowSummary usual = optimized(WindowConfig().min_relative_decrease);
  EXPECT_GT(usual.iterations, 2) << "from so far away the first ones gain much";
  EXPECT_LT(usual.iterations, all.iterations);
  EXPECT_LT(usual.final_cost, 1.1 * all.final_cost);
  EXPECT_GE(usual.final_cost, all.final_cost);
}

TEST(Window, ReblurringTargetsBeatsComparingBlurredImages) {
  WindowConfig with, without;
  without.reblur_targets = false;
  Window reblurred(with), compared(without);
  fill(reblurred, keyframesOf(views().sharp, views().blurred, true), Disturbance());
  fill(compared, keyframesOf(views().blurred, views().blurred, true), Disturbance());
  reblurred.optimize(20);
  compared.optimize(20);
  EXPECT_LT(largestPositionError(reblurred), 2e-3);
  EXPECT_GT(largestPositionError(compared), 5.0 * largestPositionError(reblurred));
}

TEST(Window, RecoversBrightness) {
  std::vector<cv::Mat1f> images;
  for (KeyframeId i = 0; i < kFrames; ++i) {
    cv::Mat1f image;
    views().sharp[i].convertTo(image, CV_32F, std::exp(0.06 * i), 3.0 * i);  // exp(a) I + b
    images.push_back(image);
  }
  Window window{WindowConfig()};
  fill(window, keyframesOf(images, images, false), Disturbance());
  window.optimize(30);
  EXPECT_LT(largestPositionError(window), 1.5e-3);
  for (KeyframeId i = 0; i < kFrames; ++i) {
    EXPECT_NEAR(window.brightness(i).a, 0.06 * i, 2e-3) << "keyframe " << i;
    EXPECT_NEAR(window.brightness(i).b, 3.0 * i, 0.3) << "keyframe " << i;
  }
}

TEST(Window, CostDoesNotDependOnTheGauge) {
  const auto images = keyframesOf(views().sharp, views().blurred, true);
  Disturbance moved;
  moved.T_world_map = SE3::exp((Vector6() << 2.0, -1.0, 0.5, 0.8, -1.2, 0.4).finished());
  moved.scale = 3.7;
  Window a{WindowConfig()}, b{WindowConfig()};
  fill(a, images, Disturbance());
  fill(b, images, moved);
  const WindowSummary summary_a = a.optimize(20);
  const WindowSummary summary_b = b.optimize(20);
  EXPECT_NEAR(summary_a.initial_cost, summary_b.initial_cost, 1e-3 * summary_a.initial_cost);
  EXPECT_NEAR(summary_a.final_cost, summary_b.final_cost, 2e-2 * summary_a.final_cost);
  EXPECT_NEAR(largestPositionError(a), largestPositionError(b), 2e-4);
}

TEST(Window, IsBitIdenticalWhateverTheThreads) {
  const auto images = keyframesOf(views().sharp, views().blurred, true);
  const auto run = [&] {
    Window window{WindowConfig()};
    fill(window, images, Disturbance());
    window.optimize(5);
    window.marginalize(1);
    window.optimize(3);
    std::vector<double> numbers;
    for (const KeyframeId id : window.keyframes()) {
      const SE3 T = window.T_map_keyframe(id);
      numbers.insert(numbers.end(), T.translation().data(), T.translation().data() + 3);
      numbers.insert(numbers.end(), T.rotation().coeffs().data(), T.rotation().coeffs().data() + 4);
    }
    for (const WindowPoint& p : window.points()) numbers.insert(numbers.end(), {p.inverse_depth, p.variance});
    return numbers;
  };
  const std::vector<double> parallel = run();
  std::vector<double> serial;
  tbb::task_arena(1).execute([&] { serial = run(); });
  EXPECT_EQ(parallel, serial);
}

TEST(Window, OccludedViewsBecomeOutliers) {
  std::vector<cv::Mat1f> images;
  for (const cv::Mat1f& image : views().sharp) images.push_back(image.clone());
  const cv::Rect hand(120, 60, 100, 120);
  for (int y = hand.y; y < hand.y + hand.height; ++y) {
    for (int x = hand.x; x < hand.x + hand.width; ++x)
      images[3](y, x) = 20.0F + 60.0F * static_cast<float>((x + y) % 7 == 0);
  }
  Window window{WindowConfig()};
  fill(window, keyframesOf(images, images, false), Disturbance());
  window.optimize(20);
  window.optimize(10);
  EXPECT_LT(largestPositionError(window), 2e-3);
}

TEST(Window, KeepsItsSizeAndTheTwoNewestKeyframes) {
  WindowConfig config;
  config.max_keyframes = config.min_keyframes = 4;
  Window window(config);
  Disturbance setup;
  setup.step = 30;
  fill(window, keyframesOf(views().sharp, views().sharp, false), setup);
  window.optimize(10);
  const std::vector<KeyframeId> leaving = window.keyframesToMarginalize();
  EXPECT_EQ(leaving.size(), 2U);
  for (const KeyframeId id : leaving) {
    EXPECT_LT(id, kFrames - 2);
    window.marginalize(id);
  }
  EXPECT_EQ(window.keyframes().size(), 3U);
  EXPECT_TRUE(window.keyframesToMarginalize().empty());
  for (const WindowPoint& p : window.points()) {
    EXPECT_EQ(std::count(leaving.begin(), leaving.end(), p.host), 0);
    EXPECT_GT(p.good_residuals, 0);
    EXPECT_GT(p.variance, 0.0);
    EXPECT_GT(p.relative_baseline, 0.0);
  }
}

TEST(Window, RefusesImpossibleInput) {
  Window window{WindowConfig()};
  WindowKeyframe keyframe;
  keyframe.id = 8;
  EXPECT_THROW(window.addKeyframe(keyframe), std::invalid_argument);  // no image
  keyframe = keyframesOf(views().sharp, views().sharp, false)[0];
  keyframe.id = 8;
  window.addKeyframe(keyframe);
  EXPECT_THROW(window.addKeyframe(keyframe), std::invalid_argument);  // twice
  EXPECT_THROW(window.addPoint(8, {10, 10}, -0.5), std::invalid_argument);
  EXPECT_THROW(window.addPoint(9, {10, 10}, 0.5), std::invalid_argument);
  try {
    window.marginalize(77);
    FAIL() << "marginalised a keyframe that is not there";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("77"), std::string::npos);
  }
  EXPECT_EQ(window.optimize(5).residuals, 0);  // one keyframe: nothing to do
}

}  // namespace
}  // namespace mba_vo::window_test
