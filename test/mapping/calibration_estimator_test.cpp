#include "mba_vo/mapping/calibration_estimator.h"

#include <gtest/gtest.h>

namespace mba_vo::calibration_estimator_test {
namespace {

using Vector = CalibrationCorrection::Vector;

/// Windows that know the truth, each with as much information about every number of the correction.
CalibrationSystem windowOf(const Vector& truth, const CalibrationCorrection& used, double information) {
  Vector sigma;
  sigma << 1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 5e-4, 1e-3, 1e-3, 1e-3;
  CalibrationSystem system;
  system.H = (information * sigma.array().square().inverse()).matrix().asDiagonal();
  system.b = -system.H * (truth - used.values);
  return system;
}

TEST(CalibrationEstimator, FindsTheTruth) {
  Vector truth;
  truth << 0.01, -0.004, 0.006, -0.02, 0.01, 0.02, -0.3, 0.1, -0.1;
  CalibrationEstimator estimator;
  for (int i = 0; i < 100; ++i) estimator.add(windowOf(truth, estimator.correction(), 1e3));
  const Vector error = (estimator.correction().values - truth).cwiseAbs();
  EXPECT_LT(error.head<5>().maxCoeff(), 1e-3);
  EXPECT_LT(error(5), 5e-4);
}

TEST(CalibrationEstimator, DoesNotMoveForWhatIsNotSignificant) {
  Vector truth = Vector::Zero();
  truth(CalibrationCorrection::kK1) = 1e-3;
  CalibrationEstimator estimator;
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(estimator.add(windowOf(truth, estimator.correction(), 1.0)));
  EXPECT_TRUE(estimator.correction().isZero());
}

/// A fiftieth of the windows' information counts, so that each adds 1 to chi^2 here.
TEST(CalibrationEstimator, StepsAsSoonAsTheErrorIsSignificant) {
  Vector truth = Vector::Zero();
  truth(CalibrationCorrection::kFocal) = 5e-3;
  CalibrationEstimator estimator;
  int windows = 1;
  while (windows < 100 && !estimator.add(windowOf(truth, estimator.correction(), 2.0))) ++windows;
  EXPECT_GE(windows, 12);
  EXPECT_LE(windows, 15) << "the prior takes a little away";
  EXPECT_GT(estimator.correction()[CalibrationCorrection::kFocal], 4e-3);
}

/// One that reads its rows in next to no time is another kind of camera, with motions of its rows to be found.
TEST(CalibrationEstimator, AGlobalShutterStaysOneWhenTheRestIsCorrected) {
  Vector truth = Vector::Zero();
  truth(CalibrationCorrection::kFocal) = 0.02;
  truth(CalibrationCorrection::kReadout) = 5e-5;
  CalibrationEstimator estimator;
  for (int i = 0; i < 20; ++i) estimator.add(windowOf(truth, estimator.correction(), 1e3));
  EXPECT_NEAR(estimator.correction()[CalibrationCorrection::kFocal], 0.02, 1e-3);
  EXPECT_EQ(estimator.correction()[CalibrationCorrection::kReadout], 0.0);
}

TEST(CalibrationEstimator, HasSettledWhenWindowsLeaveItAsItIs) {
  Vector truth = Vector::Zero();
  truth(CalibrationCorrection::kFocal) = 0.02;
  CalibrationEstimator estimator;
  for (int i = 0; i < 60 && !estimator.settled(); ++i) estimator.add(windowOf(truth, estimator.correction(), 1e3));
  ASSERT_TRUE(estimator.settled());
  EXPECT_NEAR((*estimator.settled())[CalibrationCorrection::kFocal], 0.02, 1e-3);
  const CalibrationCorrection before = *estimator.settled();
  truth(CalibrationCorrection::kFocal) = -0.02;
  while (!estimator.add(windowOf(truth, estimator.correction(), 1e3))) {
  }
  EXPECT_EQ(*estimator.settled(), before) << "what has only just been found has not settled";
}

TEST(CalibrationEstimator, WantsSeveralWindowsToAgree) {
  Vector truth = Vector::Zero();
  truth(CalibrationCorrection::kFocal) = 0.02;
  CalibrationEstimator estimator;
  EXPECT_FALSE(estimator.add(windowOf(truth, estimator.correction(), 1e6)));
  EXPECT_FALSE(estimator.add(windowOf(truth, estimator.correction(), 1e6)));
}

/// What a vignette does to a wrong geometry's residuals is not believed before the vignette is right.
TEST(CalibrationEstimator, CorrectsTheVignetteFirstAndAlone) {
  Vector truth = Vector::Zero();
  truth(CalibrationCorrection::kV1) = -0.3;
  truth(CalibrationCorrection::kFocal) = 0.01;
  CalibrationEstimator estimator;
  EXPECT_TRUE(estimator.add(windowOf(truth, estimator.correction(), 1e3))) << "one window is enough";
  EXPECT_NEAR(estimator.correction()[CalibrationCorrection::kV1], -0.3, 0.01);
  EXPECT_FALSE(estimator.correction().correctsLens());
}

TEST(CalibrationEstimator, LeavesAToldVignetteAlone) {
  Vector truth = Vector::Zero();
  truth(CalibrationCorrection::kV1) = -0.3;
  CalibrationEstimator estimator({}, CalibrationEstimator::Vignette::kTold);
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(estimator.add(windowOf(truth, estimator.correction(), 1e3)));
  EXPECT_TRUE(estimator.correction().isZero());
}

TEST(CalibrationEstimator, GoesOnFromAnEarlierCorrection) {
  CalibrationCorrection start;
  start.values(CalibrationCorrection::kReadout) = 0.015;
  CalibrationEstimator estimator(start);
  EXPECT_EQ(estimator.correction(), start);
  for (int i = 0; i < 20; ++i) estimator.add(windowOf(start.values, estimator.correction(), 1e3));
  EXPECT_NEAR(estimator.correction()[CalibrationCorrection::kReadout], 0.015, 5e-4);
}

}  // namespace
}  // namespace mba_vo::calibration_estimator_test
