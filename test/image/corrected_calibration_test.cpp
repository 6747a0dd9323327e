#include "mba_vo/image/corrected_calibration.h"

#include <cmath>

#include <gtest/gtest.h>

namespace mba_vo::corrected_calibration_test {
namespace {

CalibrationCorrection lensError() {
  CalibrationCorrection correction;
  correction.values.head<5>() << 0.01, 0.003, -0.002, -0.01, 0.004;
  return correction;
}

void expectSameRays(const CameraCalibration& told) {
  const CorrectedCalibration fitted = correctedCalibration(told, lensError());
  // A shift of the centre under a strong distortion is nothing that a model without tangential terms can say.
  EXPECT_LT(fitted.error_px, told.distortion_model == "equidistant" ? 0.7 : 0.4) << told.distortion_model;
  for (double x = -0.5; x <= 0.5; x += 0.1) {
    for (double y = -0.35; y <= 0.35; y += 0.1) {
      const Eigen::Vector2d corrected = lensError().apply({x, y});
      const cv::Point2d wanted = projectRays(told, {{corrected.x(), corrected.y(), 1.0}}).front();
      const cv::Point2d seen = projectRays(fitted.calibration, {{x, y, 1.0}}).front();
      EXPECT_NEAR(seen.x, wanted.x, fitted.error_px + 0.02) << told.distortion_model << " " << x << ", " << y;
      EXPECT_NEAR(seen.y, wanted.y, fitted.error_px + 0.02) << told.distortion_model << " " << x << ", " << y;
    }
  }
}

TEST(CorrectedCalibration, SeesWhatTheCorrectedCameraSees) {
  expectSameRays({640, 480, 460.0, 461.0, 322.0, 238.0, "plumb_bob", {0, 0, 0, 0, 0}});
  expectSameRays({640, 480, 460.0, 461.0, 322.0, 238.0, "plumb_bob", {-0.28, 0.07, 0.001, -0.002, 0.0}});
  expectSameRays({640, 480, 460.0, 461.0, 322.0, 238.0, "equidistant", {-0.03, 0.01, -0.004, 0.001}});
  expectSameRays({640, 480, 460.0, 461.0, 322.0, 238.0, "fov", {0.5}});
  expectSameRays(
      {640, 480, 460.0, 461.0, 322.0, 238.0, "rational_polynomial", {0.1, -0.05, 0.0, 0.0, 0.0, 0.3, -0.02, 0.0}});
}

/// A lens of TUM-mono, in the corners of whose images the model has no ray.
TEST(CorrectedCalibration, OfAFisheyeHeedsOnlyRaysBeforeTheCamera) {
  const CameraCalibration told{1280, 1024, 447.0, 447.0, 631.0, 511.0, "fov", {0.933}};
  ASSERT_TRUE(std::isinf(rayOfFovPixel(told, {0.0, 0.0}).x));
  CalibrationCorrection correction;
  correction.values(0) = 0.01;  // focal length
  const CorrectedCalibration fitted = correctedCalibration(told, correction);
  EXPECT_LT(fitted.error_px, 2.0);
  const cv::Point2d wanted = projectRays(told, {{0.303, 0.0, 1.0}}).front();
  EXPECT_NEAR(projectRays(fitted.calibration, {{0.3, 0.0, 1.0}}).front().x, wanted.x, 1.0);
}

TEST(CorrectedCalibration, OfACameraWithoutDistortionHasTheNumbersOfTheCorrection) {
  CalibrationCorrection correction;
  correction.values.head<3>() << 0.02, 0.006, -0.004;
  const CameraCalibration c =
      correctedCalibration({640, 480, 460.0, 450.0, 322.0, 238.0, "", {}}, correction).calibration;
  EXPECT_EQ(c.distortion_model, "plumb_bob");
  EXPECT_NEAR(c.fx, 460.0 * 1.02, 1e-3);
  EXPECT_NEAR(c.fy, 450.0 * 1.02, 1e-3);
  EXPECT_NEAR(c.cx, 322.0 + 460.0 * 0.006, 1e-3);
  EXPECT_NEAR(c.cy, 238.0 - 450.0 * 0.004, 1e-3);
}

TEST(CorrectedCalibration, WithoutACorrectionOfTheLensIsTheSame) {
  CalibrationCorrection correction;
  correction.values(CalibrationCorrection::kReadout) = 1e-5;
  const CameraCalibration told{640, 480, 460.0, 450.0, 322.0, 238.0, "", {}};
  const CameraCalibration c = correctedCalibration(told, correction).calibration;
  EXPECT_EQ(c.fx, told.fx);
  EXPECT_EQ(c.distortion_model, "");
}

}  // namespace
}  // namespace mba_vo::corrected_calibration_test
