#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "mba_vo/window/window.h"
#include "support/random.h"
#include "window/planar_scene.h"

namespace mba_vo::window_scale_test {
namespace {

constexpr KeyframeId kFrames = 4;
constexpr double kBegun = 1.1;   // scale of the first guess over the true one
constexpr double kSigma = 0.01;  // of the measured depths, relative

SE3 truth(KeyframeId i) {
  const double t = static_cast<double>(i);
  Vector6 v;
  v << 0.07 * t, 0.03 * std::sin(1.1 * t), 0.02 * std::sin(0.7 * t), 0.01 * std::sin(0.9 * t), -0.012 * t, 0.01;
  return SE3::exp(v);
}

/// All lengths too long by kBegun, except those measured at the points of the first keyframe, of which every twelfth is
/// far too long or too short.
std::unique_ptr<Window> begin(bool measured) {
  const PinholeCamera camera = test::smallCamera();
  const test::PlanarScene scene = test::PlanarScene::corner(0.4);
  auto window = std::make_unique<Window>(WindowConfig());
  for (KeyframeId i = 0; i < kFrames; ++i) {
    WindowKeyframe keyframe;
    keyframe.id = i;
    keyframe.sharp = keyframe.original = test::pyramidOf(scene.render(camera, truth(i)), camera);
    keyframe.T_map_keyframe = SE3(truth(i).rotation(), kBegun * truth(i).translation());
    window->addKeyframe(keyframe);
  }
  test::Random random(5);
  int count = 0;
  for (KeyframeId i = 0; i < 2; ++i) {
    for (int y = 12; y < camera.height - 12; y += 14) {
      for (int x = 12; x < camera.width - 12; x += 14) {
        const double d = scene.inverseDepth(camera, truth(i), {x, y});
        MeasuredDepth depth;
        if (measured && i == 0) depth = {d * (1.0 + random.normal(kSigma)), kSigma * kSigma * d * d};
        if (++count % 12 == 0) depth.inverse_depth *= count % 24 == 0 ? 0.5 : 2.0;  // belongs to something else
        window->addPoint(i, {x, y}, d / kBegun, depth);
      }
    }
  }
  std::vector<std::optional<Eigen::Vector2d>> slopes;  // the walls are slanted
  for (const WindowPoint& point : window->points()) {
    const auto at = [&](double dx, double dy) {
      return scene.inverseDepth(camera, truth(point.host), point.pixel + Eigen::Vector2d(dx, dy)) / kBegun;
    };
    slopes.emplace_back(Eigen::Vector2d(at(0.5, 0.0) - at(-0.5, 0.0), at(0.0, 0.5) - at(0.0, -0.5)));
  }
  window->setSlopes(slopes);
  return window;
}

double scaleOf(const Window& window) {
  const SE3 T = window.T_map_keyframe(1).inverse() * window.T_map_keyframe(3);
  return T.translation().norm() / (truth(1).inverse() * truth(3)).translation().norm();
}

TEST(WindowScale, StaysWithoutMeasuredDepths) {
  const auto window = begin(false);
  window->optimize(20);
  EXPECT_NEAR(scaleOf(*window), kBegun, 0.005);
}

TEST(WindowScale, IsThatOfTheMeasuredDepths) {
  const auto window = begin(true);
  window->optimize(40);
  EXPECT_NEAR(scaleOf(*window), 1.0, 0.01);
  window->marginalize(0);  // with all the points that were measured
  window->optimize(20);
  EXPECT_NEAR(scaleOf(*window), 1.0, 0.01);
}

}  // namespace
}  // namespace mba_vo::window_scale_test
