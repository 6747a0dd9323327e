#include <cmath>

#include <gtest/gtest.h>

#include "evaluation/exposure_about.h"
#include "mba_vo/evaluation/association.h"
#include "mba_vo/evaluation/exposure_motion.h"
#include "mba_vo/evaluation/statistics.h"

namespace mba_vo::metrics_test {
namespace {

TEST(Association, IsOneToOneAndTakesTheClosest) {
  const auto at = [](std::initializer_list<double> times) {
    std::vector<PoseRecord> poses;
    for (const double time : times) {
      poses.push_back({time, SE3(), std::nullopt, 0});
    }
    return poses;
  };
  const auto pairs = associateByTime(at({0.0, 1.0, 2.0, 3.0}), at({0.008, 0.992, 0.999, 2.5}), 0.01);
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_EQ(pairs[0].groundtruth, 0U);
  EXPECT_EQ(pairs[0].estimate, 0U);
  EXPECT_EQ(pairs[1].groundtruth, 1U);
  EXPECT_EQ(pairs[1].estimate, 2U);
}

TEST(Statistics, InterpolateBetweenRanks) {
  const Statistics s = summarize({4.0, 1.0, 3.0, 2.0});
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.percentile_90, 3.7);
  EXPECT_DOUBLE_EQ(s.max, 4.0);
  EXPECT_DOUBLE_EQ(s.mean, 2.5);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(7.5));
  EXPECT_TRUE(std::isnan(summarize({}).median));
}

TEST(ExposureMotion, SidewaysTranslationIsPredictedByHand) {
  const SE3 mid(Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitY())), {1, 2, 3});
  const auto truth = exposureAbout(mid, twist(0.03, 0, 0, 0, 0, 0));
  // The same, expressed in a map of another frame and half the scale, 20 % too short and 10 deg off.
  const double s = 0.5 * 0.8 * 0.03;
  const double angle = 10.0 * M_PI / 180.0;
  const auto estimate = exposureAbout(SE3(), twist(s * std::cos(angle), s * std::sin(angle), 0, 0, 0, 0));
  const auto error = compareExposureMotion(truth, estimate, 2.0, 2.0);
  ASSERT_TRUE(error.has_value());
  EXPECT_NEAR(error->blur_px, 430.0 * 0.03 / 2.0, 1e-9);
  EXPECT_NEAR(error->direction, 10.0, 1e-9);
  EXPECT_NEAR(error->length_ratio, 0.8, 1e-9);
}

TEST(ExposureMotion, SignOfRollAndYawMatters) {
  for (const Vector6& xi : {twist(0, 0, 0, 0, 0, 0.05), twist(0, 0, 0, 0, 0.03, 0), twist(0, 0, 0.1, 0, 0, 0)}) {
    const auto same = compareExposureMotion(exposureAbout(SE3(), xi), exposureAbout(SE3(), xi), 1.0, 1.0);
    const auto reversed = compareExposureMotion(exposureAbout(SE3(), xi), exposureAbout(SE3(), -xi), 1.0, 1.0);
    ASSERT_TRUE(same && reversed);
    EXPECT_NEAR(same->direction, 0.0, 1e-5);
    EXPECT_NEAR(reversed->direction, 180.0, 1.0);  // not exactly: points come from the middle, fields bend
    EXPECT_NEAR(reversed->length_ratio, 1.0, 1e-9);
  }
}

TEST(ExposureMotion, LittleBlurHasNoDirection) {
  const auto truth = exposureAbout(SE3(), twist(0.005, 0, 0, 0, 0, 0));  // 1.1 px
  EXPECT_FALSE(compareExposureMotion(truth, truth, 1.0, 2.0).has_value());
  const auto still = exposureAbout(SE3(), twist(0, 0, 0, 0, 0, 0));
  EXPECT_FALSE(compareExposureMotion(still, truth, 1.0, 0.0).has_value());
  EXPECT_DOUBLE_EQ(compareExposureMotion(truth, still, 1.0, 0.5)->direction, 90.0);
  EXPECT_DOUBLE_EQ(compareExposureMotion(truth, still, 1.0, 0.5)->length_ratio, 0.0);
}

}  // namespace
}  // namespace mba_vo::metrics_test
