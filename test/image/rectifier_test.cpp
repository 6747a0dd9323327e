#include "mba_vo/image/rectifier.h"

#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

namespace mba_vo::rectifier_test {
namespace {

CameraCalibration calibrationOf(const std::string& model, const std::vector<double>& distortion) {
  return {752, 480, 430.0, 425.0, 380.0, 235.0, model, distortion};
}

/// Where OpenCV's forward model puts a ray in the distorted image.
cv::Point2d projectDistorted(const CameraCalibration& c, const Eigen::Vector3d& ray) {
  const cv::Matx33d K(c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0);
  const std::vector<cv::Point3d> points{{ray.x(), ray.y(), ray.z()}};
  const cv::Vec3d zero(0.0, 0.0, 0.0);
  if (c.distortion_model == "fov") {  // which OpenCV lacks: the angle off the axis becomes the radius
    const double tangent = ray.head<2>().norm() / ray.z();
    const double radius = std::atan(2.0 * tangent * std::tan(c.distortion[0] / 2.0)) / c.distortion[0];
    const Eigen::Vector2d at =
        tangent > 0.0 ? Eigen::Vector2d(ray.head<2>().normalized() * radius) : Eigen::Vector2d(0, 0);
    return {c.fx * at.x() + c.cx, c.fy * at.y() + c.cy};
  }
  std::vector<cv::Point2d> pixels;
  if (c.distortion_model == "equidistant") {
    cv::fisheye::projectPoints(points, pixels, zero, zero, K, c.distortion);
  } else {
    cv::projectPoints(points, zero, zero, K, c.distortion, pixels);
  }
  return pixels[0];
}

/// Bilinear interpolation reproduces these images exactly, so they tell where a rectified pixel looks.
cv::Mat1f coordinateImage(const CameraCalibration& c, bool x_coordinate) {
  cv::Mat1f image(c.height, c.width);
  for (int y = 0; y < c.height; ++y) {
    for (int x = 0; x < c.width; ++x) image(y, x) = static_cast<float>(x_coordinate ? x : y);
  }
  return image;
}

class RectifierModels : public ::testing::TestWithParam<std::tuple<std::string, std::vector<double>>> {
 protected:
  const CameraCalibration calibration_ = calibrationOf(std::get<0>(GetParam()), std::get<1>(GetParam()));
  const Rectifier rectifier_{calibration_};
};

TEST_P(RectifierModels, LooksWhereTheForwardModelSays) {
  ASSERT_FALSE(rectifier_.isIdentity());
  const cv::Mat1f xs = rectifier_.rectify(coordinateImage(calibration_, true));
  const cv::Mat1f ys = rectifier_.rectify(coordinateImage(calibration_, false));
  int checked = 0;
  for (int v = 3; v < calibration_.height; v += 17) {
    for (int u = 2; u < calibration_.width; u += 19) {
      const cv::Point2d expected = projectDistorted(calibration_, rectifier_.camera().unproject(Eigen::Vector2d(u, v)));
      const double inside =
          std::min({expected.x, expected.y, calibration_.width - 1 - expected.x, calibration_.height - 1 - expected.y});
      if (std::abs(inside) < 1e-3) continue;  // too close to tell
      ASSERT_EQ(std::isnan(xs(v, u)), inside < 0.0) << u << ", " << v;
      if (inside < 0.0) continue;
      EXPECT_NEAR(xs(v, u), expected.x, 2e-3) << u << ", " << v;
      EXPECT_NEAR(ys(v, u), expected.y, 2e-3) << u << ", " << v;
      ++checked;
    }
  }
  EXPECT_GT(checked, 900);
}

TEST_P(RectifierModels, KeepsSizeAndMostOfTheImageValid) {
  const PinholeCamera& camera = rectifier_.camera();
  EXPECT_EQ(camera.width, calibration_.width);
  EXPECT_EQ(camera.height, calibration_.height);
  const cv::Mat1f image = rectifier_.rectify(cv::Mat1f(480, 752, 100.0F));
  int valid = 0;
  for (const float value : image) {
    if (!std::isnan(value)) {
      EXPECT_EQ(value, 100.0F);
      ++valid;
    }
  }
  EXPECT_GT(valid, 0.94 * 752 * 480);
}

TEST_P(RectifierModels, ACorrectionComesBeforeTheDistortion) {
  CalibrationCorrection correction;
  correction.values.head<CalibrationCorrection::kGeometryDim>() << 0.01, -0.006, 0.004, -0.02, 0.015, 0.0;
  const Rectifier corrected(calibration_, correction);
  EXPECT_EQ(corrected.camera().fx, rectifier_.camera().fx);
  const cv::Mat1f xs = corrected.rectify(coordinateImage(calibration_, true));
  const cv::Mat1f ys = corrected.rectify(coordinateImage(calibration_, false));
  int checked = 0;
  for (int v = 3; v < calibration_.height; v += 17) {
    for (int u = 2; u < calibration_.width; u += 19) {
      const Eigen::Vector3d ray = corrected.camera().unproject(Eigen::Vector2d(u, v));
      const Eigen::Vector2d x = correction.apply(ray.head<2>());
      const cv::Point2d expected = projectDistorted(calibration_, {x.x(), x.y(), 1.0});
      if (std::isnan(xs(v, u))) continue;
      EXPECT_NEAR(xs(v, u), expected.x, 2e-3) << u << ", " << v;
      EXPECT_NEAR(ys(v, u), expected.y, 2e-3) << u << ", " << v;
      ++checked;
    }
  }
  EXPECT_GT(checked, 500);
}

INSTANTIATE_TEST_SUITE_P(
    Models, RectifierModels,
    ::testing::Values(std::make_tuple("plumb_bob", std::vector<double>{-0.28, 0.07, 0.0002, -0.0003}),
                      std::make_tuple("plumb_bob", std::vector<double>{0.15, -0.1, 0.001, -0.0003, 0.05}),
                      std::make_tuple("rational_polynomial",
                                      std::vector<double>{0.4, -0.1, 0.0002, -0.0003, 0.01, 0.7, -0.05, 0.02}),
                      std::make_tuple("equidistant", std::vector<double>{-0.01, 0.02, -0.005, 0.001}),
                      std::make_tuple("equidistant", std::vector<double>{0.0, 0.0, 0.0, 0.0}),
                      std::make_tuple("fov", std::vector<double>{0.93})));

TEST(Rectifier, BarrelDistortionKeepsTheFieldOfView) {
  const Rectifier rectifier(calibrationOf("plumb_bob", {-0.28, 0.07, 0.0, 0.0}));
  EXPECT_LT(rectifier.camera().fx, 0.95 * 430.0);
  EXPECT_NEAR(rectifier.camera().fx / rectifier.camera().fy, 430.0 / 425.0, 1e-12);
}

TEST(Rectifier, FoldedDistortionIsNotTakenForImage) {
  // This polynomial turns back at r = 0.82: rays further out are mapped into the image, but the camera cannot see them.
  const CameraCalibration calibration = calibrationOf("plumb_bob", {-0.5, 0.0, 0.0, 0.0});
  const Rectifier rectifier(calibration);
  const cv::Mat1f image = rectifier.rectify(cv::Mat1f(480, 752, 1.0F));
  for (int v = 0; v < 480; v += 4) {
    for (int u = 0; u < 752; u += 4) {
      const Eigen::Vector3d ray = rectifier.camera().unproject(Eigen::Vector2d(u, v));
      if (ray.head<2>().norm() > 0.818) {
        EXPECT_TRUE(std::isnan(image(v, u))) << u << ", " << v;
      }
    }
  }
}

TEST(Rectifier, UndistortedIsIdentity) {
  const std::vector<std::tuple<std::string, std::vector<double>>> undistorted{
      {"plumb_bob", {0.0, 0.0, 0.0, 0.0, 0.0}},
      {"", {}},
      {"fov", {0.0}},
      {"rational_polynomial", std::vector<double>(8, 0.0)}};
  for (const auto& [model, distortion] : undistorted) {
    const Rectifier rectifier(calibrationOf(model, distortion));
    EXPECT_TRUE(rectifier.isIdentity()) << model;
    EXPECT_EQ(rectifier.camera().fx, 430.0);
    EXPECT_EQ(rectifier.camera().cy, 235.0);
  }
}

TEST(Rectifier, DepthsAreThoseOfTheNearestPixel) {
  const CameraCalibration calibration = calibrationOf("plumb_bob", {-0.28, 0.07, 0.0, 0.0});
  const Rectifier rectifier(calibration);
  cv::Mat1f source(480, 752);
  for (int y = 0; y < source.rows; ++y) {
    for (int x = 0; x < source.cols; ++x) source(y, x) = static_cast<float>(1000 * y + x);  // tells where it was read
  }
  source(200, 300) = std::nanf("");
  const cv::Mat1f depth = rectifier.rectifyDepth(source);
  int unknown = 0;
  for (int v = 0; v < 480; v += 1) {
    for (int u = 0; u < 752; u += 1) {
      const cv::Point2d at = projectDistorted(calibration, rectifier.camera().unproject(Eigen::Vector2d(u, v)));
      const double margin = std::min(std::abs(at.x - std::floor(at.x) - 0.5), std::abs(at.y - std::floor(at.y) - 0.5));
      if (margin < 0.01 || at.x < 0.01 || at.y < 0.01 || at.x > 750.99 || at.y > 478.99) continue;
      const float expected = source(static_cast<int>(std::lround(at.y)), static_cast<int>(std::lround(at.x)));
      unknown += std::isnan(expected) ? 1 : 0;
      ASSERT_TRUE(depth(v, u) == expected || (std::isnan(depth(v, u)) && std::isnan(expected))) << u << ", " << v;
    }
  }
  EXPECT_GE(unknown, 1);
  EXPECT_TRUE(std::isnan(depth(0, 0)) || rectifier.rectify(source)(0, 0) >= 0.0F);  // outside is unknown
}

TEST(Rectifier, InvalidSourcePixelsSpreadOverTheirFootprint) {
  const CameraCalibration calibration = calibrationOf("plumb_bob", {-0.28, 0.07, 0.0, 0.0});
  const Rectifier rectifier(calibration);
  cv::Mat1f source(480, 752, 10.0F);
  source(200, 300) = std::nanf("");
  const cv::Mat1f image = rectifier.rectify(source);
  int invalid = 0;
  for (int v = 100; v < 380; ++v) {
    for (int u = 100; u < 650; ++u) {
      const cv::Point2d at = projectDistorted(calibration, rectifier.camera().unproject(Eigen::Vector2d(u, v)));
      const double distance = std::max(std::abs(at.x - 300.0), std::abs(at.y - 200.0));
      if (std::abs(distance - 1.0) < 0.01) continue;
      EXPECT_EQ(std::isnan(image(v, u)), distance < 1.0) << u << ", " << v;
      if (distance < 1.0) ++invalid;
    }
  }
  EXPECT_GE(invalid, 1);
}

}  // namespace
}  // namespace mba_vo::rectifier_test
