#include <cmath>
#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>

#include "simulation/test_scenes.h"

namespace mba_vo::distortion_test {
namespace {

CameraCalibration lens(const std::string& model, const std::vector<double>& coefficients) {
  return {320, 240, 180.0, 182.0, 161.3, 118.2, model, coefficients};
}

cv::Point2d projectByOpenCv(const CameraCalibration& c, const cv::Point3d& point) {
  const cv::Matx33d K(c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
  const std::vector<cv::Point3d> points = {point};
  std::vector<cv::Point2d> pixels;
  const cv::Vec3d zero(0, 0, 0);
  if (c.distortion_model == "fov") {  // which OpenCV lacks
    const cv::Point2d ray(point.x / point.z, point.y / point.z);
    const double tangent = std::max(1e-9, cv::norm(ray));
    const double scale = std::atan(2.0 * tangent * std::tan(0.5 * c.distortion[0])) / c.distortion[0] / tangent;
    return {c.fx * scale * ray.x + c.cx, c.fy * scale * ray.y + c.cy};
  }
  if (c.distortion_model == "equidistant") {
    cv::fisheye::projectPoints(points, pixels, zero, zero, K, c.distortion);
  } else {
    cv::projectPoints(points, zero, zero, K, c.distortion, pixels);
  }
  return pixels.front();
}

cv::Point2d centroid(const cv::Mat1f& image) {
  double sum = 0.0;
  cv::Point2d moment(0.0, 0.0);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const double value = static_cast<double>(image(y, x));
      sum += value;
      moment += value * cv::Point2d(x, y);
    }
  }
  return moment / sum;
}

TEST(Distortion, PointsLandWhereOpenCvProjectsThem) {
  const CameraCalibration lenses[] = {
      lens("plumb_bob", {-0.28, 0.07, 2e-4, -3e-4, 0.0}),
      lens("plumb_bob", {}),
      lens("rational_polynomial", {0.4, 0.1, 1e-4, 2e-4, 0.01, 0.7, 0.2, 0.03}),
      lens("equidistant", {0.01, -0.005, 0.002, -0.0005}),
      lens("fov", {0.93}),
  };
  for (const CameraCalibration& calibration : lenses) {
    for (const Eigen::Vector2d& at :
         {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(-1.1, 0.8), Eigen::Vector2d(1.2, -0.7)}) {
      Scene scene = emptyScene();
      cv::Mat1f bump(64, 64);  // smooth and black at its border: its centre of light survives sampling
      for (int i = 0; i < 64 * 64; ++i) {
        const double x = (i % 64 - 31.5) / 8.0;
        const double y = (i / 64 - 31.5) / 8.0;
        bump(i / 64, i % 64) = static_cast<float>(std::exp(-0.5 * (x * x + y * y)));
      }
      scene.textures.emplace_back([bump] { return Texture(bump); });
      constexpr double kHalf = 0.06;  // [m]
      const double z = 1.7;
      Surface lamp = facing(at.x() - kHalf, at.y() - kHalf, at.x() + kHalf, at.y() + kHalf, z, 3);
      lamp.scale_u = lamp.scale_v = 64.0 / (2.0 * kHalf);
      lamp.offset_u = lamp.offset_v = -0.5;
      scene.surfaces = {facing(-9.0, -9.0, 9.0, 9.0, 2.0, 0), lamp};
      const Renderer renderer(std::make_shared<const Scene>(std::move(scene)), calibration, {});
      const cv::Point2d seen = centroid(renderer.integrate(slide({0, 0, 0}), 0.0, 0.0));
      const cv::Point2d expected = projectByOpenCv(calibration, {at.x(), at.y(), z});
      EXPECT_LT(cv::norm(seen - expected), 0.03)
          << calibration.distortion_model << " at " << at.transpose() << ": " << seen << " for " << expected;
    }
  }
}

TEST(Distortion, ThatCannotBeUndoneIsRefused) {
  const CameraCalibration folding = lens("plumb_bob", {-1.5, 0.0, 0.0, 0.0, 0.0});
  try {
    const RayTable table(folding, 8);
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("distortion"), std::string::npos);
  }
}

}  // namespace
}  // namespace mba_vo::distortion_test
