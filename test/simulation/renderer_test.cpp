#include "mba_vo/simulation/renderer.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "simulation/test_scenes.h"

namespace mba_vo::renderer_test {
namespace {

constexpr double kFocal = 200.0;    // [px]
constexpr double kExposure = 0.02;  // [s]

CameraCalibration calibration() { return {160, 120, kFocal, kFocal, 79.5, 59.5, "plumb_bob", {}}; }

Renderer makeRenderer(Scene&& scene, const RendererConfig& config = {}) {
  return Renderer(std::make_shared<const Scene>(std::move(scene)), calibration(), config);
}

/// Mean of a row of samples over [x - length/2, x + length/2], the samples joined by straight lines.
double boxMean(const cv::Mat1f& image, int row, double x, double length) {
  const auto value = [&](double at) {
    const int left = static_cast<int>(std::floor(at));
    const double part = at - left;
    return (1.0 - part) * static_cast<double>(image(row, left)) + part * static_cast<double>(image(row, left + 1));
  };
  constexpr int kSteps = 400;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) sum += value(x + length * ((i + 0.5) / kSteps - 0.5));
  return sum / kSteps;
}

TEST(Renderer, BlurOfATranslationIsTheBoxFilterOfTheSharpImage) {
  Scene scene = emptyScene();
  const double z = 2.0;
  scene.surfaces = {facing(-4.0, -4.0, 4.0, 4.0, z, 2)};
  scene.surfaces[0].scale_u = scene.surfaces[0].scale_v = 50.0;  // coarser than a pixel: no mip-mapping
  const auto shared_scene = std::make_shared<const Scene>(std::move(scene));
  const Renderer renderer(shared_scene, calibration(), {});
  const CameraCalibration fine{640, 120, 4.0 * kFocal, kFocal, 4.0 * 80.0 - 0.5, 59.5, "plumb_bob", {}};
  const Renderer fine_renderer(shared_scene, fine, {});
  for (const double blur : {3.0, 12.0, 20.5}) {
    const PoseFunction pose = slide({blur * z / kFocal / kExposure, 0.0, 0.0});
    const cv::Mat1f sharp = fine_renderer.integrate(pose, 0.0, 0.0);  // four times as many columns
    const cv::Mat1f blurred = renderer.integrate(pose, 0.0, kExposure);
    double worst = 0.0;
    double contrast = 0.0;
    for (int y = 0; y < 120; ++y) {
      for (int x = 15; x < 145; ++x) {
        worst = std::max(
            worst, std::abs(static_cast<double>(blurred(y, x)) - boxMean(sharp, y, 4.0 * (x + 0.5) - 0.5, 4.0 * blur)));
        contrast = std::max(contrast, static_cast<double>(std::abs(blurred(y, x) - sharp(y, 4 * x + 2))));
      }
    }
    EXPECT_LT(worst, 0.5) << blur << " px";
    EXPECT_GT(contrast, 10.0) << "the texture is too flat to show anything";
  }
}

TEST(Renderer, MovingEdgeBecomesAnExactRampAlsoAtAnOcclusion) {
  Scene scene = emptyScene();
  scene.surfaces = {facing(-4.0, -4.0, 4.0, 4.0, 2.0, 0), facing(0.0, -4.0, 4.0, 4.0, 1.0, 1)};
  const Renderer renderer = makeRenderer(std::move(scene));
  const double blur = 10.0;
  const cv::Mat1f image = renderer.integrate(slide({blur / kFocal / kExposure, 0.0, 0.0}), 0.0, kExposure);
  const double edge = 79.5;  // image of x = 0 at mid-exposure
  for (int x = 0; x < 160; ++x) {
    // Bright where x lies right of the edge, which sweeps over edge +- blur/2; the pixel is one wide.
    double bright = 0.0;
    constexpr int kSteps = 1000;
    for (int i = 0; i < kSteps; ++i) {
      const double at = edge + blur * ((i + 0.5) / kSteps - 0.5);
      bright += std::clamp(x + 0.5 - at, 0.0, 1.0) / kSteps;
    }
    EXPECT_NEAR(image(60, x), 0.8 * 255.0 * bright, 1.0) << "column " << x;
  }
}

TEST(Renderer, SharpEdgesAreAntiAliased) {
  Scene scene = emptyScene();
  // A tilted square: the light it sends is its area, wherever the pixel borders lie.
  Surface square = facing(0.0, 0.0, 0.3, 0.3, 2.0, 1);
  const double angle = 0.37;
  square.origin = {-0.123, 0.211, 2.0};
  square.axis_u = {std::cos(angle), std::sin(angle), 0.0};
  square.axis_v = {std::sin(angle), -std::cos(angle), 0.0};
  scene.surfaces = {facing(-4.0, -4.0, 4.0, 4.0, 3.0, 0), square};
  const cv::Mat1f image = makeRenderer(std::move(scene)).integrate(slide({0, 0, 0}), 0.0, 0.0);
  const double area = std::pow(0.3 * kFocal / 2.0, 2);  // [px^2]
  EXPECT_NEAR(cv::sum(image)[0] / (0.8 * 255.0), area, 1e-3 * area);
  EXPECT_GT(cv::countNonZero((image > 20.0F) & (image < 180.0F)), 60);
}

TEST(Renderer, HalfTheStepChangesLittle) {
  SimulationConfig config;
  config.resize(376, 240);
  const Simulator simulator(config, sharedRoom());
  const PoseFunction pose = [&](double t) { return simulator.pose(t); };
  const Renderer coarse(sharedRoom(), config.calibration(), {0.5, 0.0});
  const Renderer fine(sharedRoom(), config.calibration(), {0.25, 0.0});
  for (const int index : {10, 80, 150, 220}) {
    const double t = simulator.time(index);
    EXPECT_GT(fine.subFrames(pose, t, kExposure), coarse.subFrames(pose, t, kExposure));
    cv::Mat difference = cv::abs(coarse.integrate(pose, t, kExposure) - fine.integrate(pose, t, kExposure));
    const int above = cv::countNonZero(difference > 0.5);
    EXPECT_LT(cv::mean(difference)[0], 0.07);
    EXPECT_LT(above, 0.04 * static_cast<double>(difference.total())) << "frame " << index;
  }
}

TEST(Renderer, NoSubFrameStepAboveHalfAPixel) {
  const SimulationConfig config = smallConfig();
  const Simulator simulator(config, sharedRoom());
  const PoseFunction pose = [&](double t) { return simulator.pose(t); };
  const PinholeCamera camera = config.camera();
  for (const int index : {30, 120, 200}) {
    const double t = simulator.time(index);
    const cv::Mat1f depth = simulator.renderer().depth(pose, t);
    const int count = simulator.renderer().subFrames(pose, t, kExposure);
    double largest = 0.0;
    for (int i = 1; i < count; ++i) {
      const SE3 T_a_mid = pose(t + kExposure * ((i - 0.5) / count - 0.5)).inverse() * pose(t);
      const SE3 T_b_mid = pose(t + kExposure * ((i + 0.5) / count - 0.5)).inverse() * pose(t);
      for (int y = 0; y < depth.rows; y += 7) {
        for (int x = 0; x < depth.cols; x += 7) {
          const Eigen::Vector3d point = static_cast<double>(depth(y, x)) * camera.unproject({x, y});
          largest = std::max(largest, (camera.project(T_a_mid * point) - camera.project(T_b_mid * point)).norm());
        }
      }
    }
    EXPECT_LE(largest, 0.5);
    EXPECT_GT(largest, 0.1) << "more sub-frames than needed";
  }
}

TEST(Renderer, NearerSurfacesHideFartherOnes) {
  Scene scene = emptyScene();
  scene.surfaces = {facing(-0.2, -0.2, 0.2, 0.2, 1.0, 1), facing(-4.0, -4.0, 4.0, 4.0, 2.0, 0)};
  const Renderer renderer = makeRenderer(std::move(scene));
  const cv::Mat1f depth = renderer.depth(slide({0, 0, 0}), 0.0);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      const bool near = std::abs(x - 79.5) < 40.0 && std::abs(y - 59.5) < 40.0;
      EXPECT_NEAR(depth(y, x), near ? 1.0 : 2.0, 1e-5) << x << ' ' << y;
    }
  }
}

TEST(Renderer, RollingShutterShearsBySpeedTimesRowTime) {
  Scene scene = emptyScene();
  scene.surfaces = {facing(-4.0, -4.0, 4.0, 4.0, 2.0, 0), facing(0.0, -4.0, 4.0, 4.0, 2.0 - 1e-6, 1)};
  const double speed = 1.5;       // [m/s]
  const double row_time = 40e-6;  // [s]
  const Renderer renderer = makeRenderer(std::move(scene), {0.5, row_time});
  for (const double exposure : {0.0, 0.004}) {
    const cv::Mat1f image = renderer.integrate(slide({speed, 0.0, 0.0}), 0.0, exposure);
    for (int y = 0; y < 120; ++y) {
      // White from the edge to the last column, which ends at 159.5.
      const double edge = 159.5 - cv::sum(image.row(y))[0] / (0.8 * 255.0);
      const double expected = 79.5 - (y - 59.5) * row_time * speed * kFocal / 2.0;
      EXPECT_NEAR(edge, expected, 0.02) << "row " << y;
    }
  }
}

/// A camera that turns by 6 rad/s and flies by 8 m/s, beyond anything recorded.
SE3 violent(double t) {
  Vector6 xi;
  xi << 4.0, 0.0, 7.0, 0.0, 6.0, 1.0;
  Eigen::Matrix3d R_world_camera;
  R_world_camera << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  return SE3(Eigen::Quaterniond(R_world_camera), {0.2, -0.1, 1.4}) * SE3::exp(t * xi);
}

TEST(Renderer, RowsOfARollingShutterSeeAllThatTheirInstantShows) {
  const CameraCalibration camera = smallConfig().calibration();
  const double row_time = 2e-4;  // [s]; 24 ms for the image
  const Renderer rolling(sharedRoom(), camera, {0.5, row_time});
  const Renderer global(sharedRoom(), camera, {0.5, 0.0});
  for (const double t_mid : {-0.05, 0.05}) {
    const cv::Mat1f depth = rolling.depth(violent, t_mid);
    const cv::Mat1f light = rolling.integrate(violent, t_mid, 0.006);
    for (int row = 0; row < camera.height; row += 28) {
      const double t_row = t_mid + row_time * (row - 0.5 * (camera.height - 1));
      const cv::Mat1f true_depth = global.depth(violent, t_row).row(row);
      EXPECT_LT(cv::norm(depth.row(row), true_depth, cv::NORM_INF), 1e-3) << "row " << row << " at " << t_mid;
      const cv::Mat1f true_light = global.integrate(violent, t_row, 0.006).row(row);
      EXPECT_LT(cv::norm(light.row(row), true_light, cv::NORM_L1) / camera.width, 0.3)
          << "row " << row << " at " << t_mid;
    }
  }
}

}  // namespace
}  // namespace mba_vo::renderer_test
