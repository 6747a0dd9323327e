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
  Window together(WindowConfig(), true);
  Window in_turn(WindowConfig(), true);
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
  Window window(WindowConfig(), true);
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

TEST(WindowActivation, AKeyframeThatCannotSeeAPointHasNoResidualOfIt) {
  Window window(WindowConfig(), true);
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
