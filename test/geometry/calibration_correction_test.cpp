#include "mba_vo/geometry/calibration_correction.h"

#include <cmath>

#include <gtest/gtest.h>

#include "support/jacobian.h"
#include "support/random.h"

namespace mba_vo::calibration_correction_test {
namespace {

const PinholeCamera kCamera{640, 480, 460.0, 455.0, 321.0, 238.0};

CalibrationCorrection vignette(double v1, double v2, double v3) {
  CalibrationCorrection correction;
  correction.values.tail<3>() << v1, v2, v3;
  return correction;
}

TEST(CalibrationCorrection, LensJacobianIsThatOfItsFormula) {
  test::Random random(1);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector2d pixel(random.uniform(0, 639), random.uniform(0, 479));
    const Eigen::Vector3d ray = kCamera.unproject(pixel);
    const auto moved = [&](const Eigen::VectorXd& d) -> Eigen::VectorXd {
      CalibrationCorrection correction;
      correction.values = d;
      const Eigen::Vector2d x = correction.apply(ray.head<2>());
      return kCamera.project({x.x(), x.y(), 1.0});
    };
    const Eigen::MatrixXd numeric = test::numericJacobian(moved, CalibrationCorrection::kDim, 1e-4);
    EXPECT_LT((lensJacobian(kCamera, pixel) - numeric).cwiseAbs().maxCoeff(), 1e-5);
  }
}

TEST(CalibrationCorrection, APinholeCameraTakesOverMostOfIt) {
  CalibrationCorrection correction = vignette(-0.3, 0.0, 0.0);
  correction.values.head<6>() << 0.02, 0.01, -0.02, -0.1, 0.02, 1e-5 * kCamera.height;
  const CalibrationCorrection part = pinholePart(correction, kCamera);
  const CalibrationCorrection rest = part.lacks(correction);
  EXPECT_TRUE(pinholePart(rest, kCamera).isZero());
  EXPECT_EQ(rest[CalibrationCorrection::kK1], -0.1);
  EXPECT_FALSE(part.correctsVignette());
  const auto shift = [](const CalibrationCorrection& c) {
    double squares = 0.0;
    for (int x = 0; x < kCamera.width; x += 20) {
      for (int y = 0; y < kCamera.height; y += 20) squares += (lensJacobian(kCamera, {x, y}) * c.values).squaredNorm();
    }
    return std::sqrt(squares);
  };
  CalibrationCorrection without_radial;
  without_radial.values(CalibrationCorrection::kFocal) = correction[CalibrationCorrection::kFocal];
  EXPECT_LT(shift(rest), 0.5 * shift(without_radial.lacks(correction)));
  const PinholeCamera corrected = withCorrection(kCamera, part);
  EXPECT_DOUBLE_EQ(corrected.row_time, 1e-5);
  test::Random random(2);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d ray = kCamera.unproject({random.uniform(0, 639), random.uniform(0, 479)});
    const Eigen::Vector2d x = part.apply(ray.head<2>());
    EXPECT_LT((corrected.project(ray) - kCamera.project({x.x(), x.y(), 1.0})).norm(), 1e-9);
  }
}

TEST(CalibrationCorrection, IsNoticeableFromHalfAPixelTwoPercentOfTheLightOrAMillisecondOn) {
  const auto focal = [](double value) {
    CalibrationCorrection correction;
    correction.values(CalibrationCorrection::kFocal) = value;
    return correction;
  };
  const auto readout = [](double value) {
    CalibrationCorrection correction;
    correction.values(CalibrationCorrection::kReadout) = value;
    return correction;
  };
  EXPECT_FALSE(isNoticeable({}, kCamera));
  const double corner = Eigen::Vector2d(kCamera.cx, kCamera.cy).norm();  // [px]
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_FALSE(isNoticeable(focal(sign * 0.45 / corner), kCamera));
    EXPECT_TRUE(isNoticeable(focal(sign * 0.55 / corner), kCamera));
    EXPECT_FALSE(isNoticeable(vignette(sign * 0.018, 0.0, 0.0), kCamera));
    EXPECT_TRUE(isNoticeable(vignette(sign * 0.022, 0.0, 0.0), kCamera));
    EXPECT_TRUE(isNoticeable(vignette(sign * 0.2, -sign * 0.2, 0.0), kCamera))
        << "the corner is right, the rest is not";
    EXPECT_FALSE(isNoticeable(readout(sign * 9e-4), kCamera));
    EXPECT_TRUE(isNoticeable(readout(sign * 11e-4), kCamera));
  }
}

TEST(CalibrationCorrection, VignetteIsNoneInTheMiddleAndAllOfItInTheCorner) {
  EXPECT_EQ(vignetteJacobian(kCamera, {kCamera.cx, kCamera.cy}).norm(), 0.0);
  const CalibrationCorrection::Vignette corner =
      vignetteJacobian(kCamera, Eigen::Vector2d(kCamera.cx, kCamera.cy) + Eigen::Vector2d(320.0, -240.0));
  EXPECT_LT((corner - CalibrationCorrection::Vignette::Ones()).norm(), 1e-12);
}

/// Images made with corrections that lack something show the same light as their vignettes let them.
TEST(CalibrationCorrection, VignetteRatioIsThatOfTheTransmissions) {
  const CalibrationCorrection truth = vignette(-0.3, 0.1, -0.2);
  const CalibrationCorrection host = vignette(-0.1, 0.0, 0.0);
  const CalibrationCorrection target;
  const VignetteRatio ratio(kCamera, host.lacks(truth), kCamera, target.lacks(truth));
  const auto shown = [&](const CalibrationCorrection& made_with, const Eigen::Vector2d& pixel) {
    const CalibrationCorrection::Vignette q = vignetteJacobian(kCamera, pixel);
    return std::exp(truth.vignette().dot(q)) / std::exp(made_with.vignette().dot(q));
  };
  const Eigen::Vector2d from(100.0, 50.0);
  const Eigen::Vector2d to(400.0, 300.0);
  EXPECT_NEAR(ratio.at(from, to), shown(target, to) / shown(host, from), 1e-12);
  EXPECT_EQ(VignetteRatio().at(from, to), 1.0);
}

}  // namespace
}  // namespace mba_vo::calibration_correction_test
