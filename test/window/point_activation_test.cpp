#include "mba_vo/window/point_activation.h"

#include <cmath>

#include <gtest/gtest.h>

#include "support/random.h"
#include "window/planar_scene.h"

namespace mba_vo::point_activation_test {
namespace {

TEST(ProjectPoints, GivesTheTrueDepthInAnotherCamera) {
  const test::PlanarScene scene = test::PlanarScene::corner();
  const PinholeCamera camera = test::smallCamera();
  const SE3 T_map_host = SE3();
  Vector6 motion;
  motion << 0.1, -0.05, 0.15, 0.02, -0.05, 0.03;
  const SE3 T_map_camera = SE3::exp(motion);
  Window window{WindowConfig{}};
  const auto host = test::pyramidOf(scene.render(camera, T_map_host), camera);
  const auto other = test::pyramidOf(scene.render(camera, T_map_camera), camera);
  window.addKeyframe({0, host, host, T_map_host, Vector6::Zero(), Vector6::Zero(), {}});
  window.addKeyframe({1, other, other, T_map_camera, Vector6::Zero(), Vector6::Zero(), {}});
  int inside = 0;
  for (int y = 20; y < 220; y += 20) {
    for (int x = 20; x < 300; x += 20) {
      const double d = scene.inverseDepth(camera, T_map_host, {x, y});
      window.addPoint(0, {x, y}, d);
      const Eigen::Vector3d seen = T_map_camera.inverse() * (camera.unproject({x, y}) / d);
      inside += camera.contains(camera.project(seen), 6.0) ? 1 : 0;
    }
  }
  const std::vector<ReferencePoint> projected = projectPoints(window, window.points(), camera, T_map_camera);
  EXPECT_GE(static_cast<int>(projected.size()), inside);
  EXPECT_LT(projected.size(), 140U);  // some leave the image
  int exact = 0;
  for (const ReferencePoint& point : projected) {
    EXPECT_TRUE(camera.contains(point.pixel.cast<double>()));
    EXPECT_GT(point.variance, 0.0F);
    // Where another plane of the scene stands in between, the depth differs.
    const double truth = scene.inverseDepth(camera, T_map_camera, point.pixel.cast<double>());
    exact += std::abs(static_cast<double>(point.inverse_depth) - truth) < 1e-4 ? 1 : 0;
  }
  EXPECT_GT(exact, static_cast<int>(projected.size()) * 9 / 10);
}

TEST(ProjectPoints, KnowsThatTheHostWasMadeWithAnotherFocalLength) {
  const test::PlanarScene scene = test::PlanarScene::corner();
  const PinholeCamera camera = test::smallCamera();
  CalibrationCorrection known;
  known.values(CalibrationCorrection::kFocal) = -0.02;
  Window window{WindowConfig{}};
  const auto image = test::pyramidOf(scene.render(camera, SE3()), camera);
  WindowKeyframe host{0, image, image, SE3(), Vector6::Zero(), Vector6::Zero(), {}};
  WindowKeyframe target = host;
  target.id = 1;
  target.correction = known;
  window.setCorrection(known);
  window.addKeyframe(host);
  window.addKeyframe(target);
  window.addPoint(0, {40.0, 60.0}, 0.5);
  const std::vector<ReferencePoint> seen = pointsSeenBy(window, window.points(), 1);
  ASSERT_EQ(seen.size(), 1U);
  // The host shows at (40, 60) what an image made with the right focal length shows farther out.
  EXPECT_NEAR(static_cast<double>(seen[0].pixel.x()), camera.cx + (40.0 - camera.cx) / 0.98, 0.01);
  EXPECT_NEAR(static_cast<double>(seen[0].pixel.y()), camera.cy + (60.0 - camera.cy) / 0.98, 0.01);
}

}  // namespace
}  // namespace mba_vo::point_activation_test
