#include <cmath>

#include <gtest/gtest.h>

#include "mba_vo/window/window.h"
#include "support/random.h"
#include "window/planar_views.h"

namespace mba_vo::window_activation_test {
namespace {

using test::views;

/// At the truth, with few points.
void settle(Window& window) {
  test::Disturbance truth;
  truth.pose_noise = 0.0;
  truth.depth_noise = 0.0;
  truth.step = 40;
  test::fill(window, test::keyframesOf(views().sharp, views().sharp, false), truth);
  window.optimize(5);
}

TEST(WindowActivation, PointsTriedSideBySideAreThoseTriedInTurn) {
  Window together{WindowConfig()};
  Window in_turn{WindowConfig()};
  const test::Views& v = views();
  std::vector<NewPoint> candidates;
  for (int x = 30; x < v.camera.width - 30; x += 7) {
    candidates.push_back({2, {x, 50}, 1.05 * v.scene.inverseDepth(v.camera, v.truth[2], {x, 50})});
  }
  for (Window* window : {&together, &in_turn}) settle(*window);
  const std::vector<bool> added = together.activatePoints(candidates);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    EXPECT_EQ(in_turn.activatePoints({candidates[i]}).front(), added[i]);
  }
  const std::vector<WindowPoint> points = together.points();
  const std::vector<WindowPoint> expected = in_turn.points();
  ASSERT_EQ(points.size(), expected.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(points[i].pixel, expected[i].pixel);
    EXPECT_EQ(points[i].inverse_depth, expected[i].inverse_depth);
  }
}

TEST(WindowActivation, RefinesDepthsAndRefusesBadPoints) {
  Window window{WindowConfig()};
  settle(window);
  const test::Views& v = views();
  test::Random random(9);
  int good = 0, tried = 0, accepted_wrong = 0;
  for (int y = 30; y < v.camera.height - 30; y += 11) {
    for (int x = 30; x < v.camera.width - 30; x += 11) {
      const double d = v.scene.inverseDepth(v.camera, v.truth[2], {x, y});
      ++tried;
      const bool added = window.activatePoints({{2, {x, y}, d * std::exp(random.normal(0.05))}}).front();
      if (added && std::abs(window.points().back().inverse_depth / d - 1.0) < 0.02) ++good;
      accepted_wrong += window.activatePoints({{2, {x, y}, 4.0 * d}}).front() ? 1 : 0;
    }
  }
  EXPECT_GT(good, tried * 8 / 10);
  EXPECT_LT(accepted_wrong, tried / 10);
  EXPECT_FALSE(window.activatePoints({{2, {100, 100}, -1.0}}).front());
}

/// A keyframe, one 5 px and one 31 px to the side of it, of a wall that looks the same again after 16 px.
class WallpaperActivation : public testing::Test {
 protected:
  WallpaperActivation() {
    for (const double x : {0.0, 0.05, 0.3}) {
      const SE3 pose(Eigen::Quaterniond::Identity(), {x, 0.0, 0.0});
      const auto image = test::pyramidOf(scene_.render(camera_, pose), camera_);
      window_.addKeyframe({keyframes_++, image, image, pose, Vector6::Zero(), Vector6::Zero(), {}});
    }
  }

  /// Of the points begun `factor` times too near, whose depth may be `relative_sigma` off: the share that ends right.
  double shareRight(double factor, double relative_sigma) {
    int tried = 0, right = 0;
    for (int x = 75; x < 300; x += 11) {
      for (int y = 25; y < 220; y += 11) {
        const double guess = factor / kDistance;
        ++tried;
        if (!window_.activatePoints({{0, {x, y}, guess, relative_sigma * guess}}).front()) continue;
        right += std::abs(kDistance * window_.points().back().inverse_depth - 1.0) < 0.02 ? 1 : 0;
      }
    }
    return static_cast<double>(right) / tried;
  }

  static constexpr double kDistance = 2.5;
  const PinholeCamera camera_ = test::smallCamera();
  const test::PlanarScene scene_ = test::PlanarScene::wallpaper(kDistance, 16.0 * kDistance / camera_.fx);
  Window window_{WindowConfig()};
  KeyframeId keyframes_ = 0;
};

TEST_F(WallpaperActivation, KeyframesOutOfReachWaitUntilTheDepthIsCertain) {
  for (const double factor : {0.7, 1.3}) {
    EXPECT_GT(shareRight(factor, 0.4), 0.9) << factor;
    EXPECT_LT(shareRight(factor, 0.0), 0.6) << factor << ": compared with all at once";
  }
}

TEST(WindowActivation, AKeyframeThatCannotSeeAPointHasNoResidualOfIt) {
  Window window{WindowConfig()};
  settle(window);
  const test::Views& v = views();
  constexpr double kNear = 8.0;  // [px] to the border: either may be
  int least = 0, most = 0, all = 0;
  const int before = window.residualCount();
  for (int x = 12; x < v.camera.width - 12; x += 7) {
    const Eigen::Vector2d pixel(x, 50);
    const double d = v.scene.inverseDepth(v.camera, v.truth[0], pixel);
    if (!window.activatePoints({{0, pixel, d}}).front()) continue;
    for (std::size_t i = 1; i < v.truth.size(); ++i) {
      const Eigen::Vector3d seen = v.truth[i].inverse() * (v.truth[0] * (v.camera.unproject(pixel) / d));
      most += v.camera.contains(v.camera.project(seen), 0.0) ? 1 : 0;
      least += v.camera.contains(v.camera.project(seen), kNear) ? 1 : 0;
      ++all;
    }
  }
  const int added = window.residualCount() - before;
  EXPECT_GE(added, least);
  EXPECT_LE(added, most);
  EXPECT_GT(least, 0);
  EXPECT_LT(most, all);
}

}  // namespace
}  // namespace mba_vo::window_activation_test
