#include "mba_vo/solver/residual_spread.h"

#include <cmath>

#include <gtest/gtest.h>

#include "support/random.h"

namespace mba_vo::residual_spread_test {
namespace {

TEST(ResidualSpread, IsTheStandardDeviationWhateverTheOutliers) {
  test::Random random(1);
  std::vector<float> sizes;
  for (int i = 0; i < 20000; ++i) sizes.push_back(static_cast<float>(std::abs(random.normal(2.5))));
  EXPECT_NEAR(residualSpread(sizes), 2.5, 0.05);
  sizes.resize(22000, 200.0F);
  EXPECT_NEAR(residualSpread(sizes), 2.5, 0.4);
}

TEST(ResidualSpread, OfNothingIsZero) {
  std::vector<float> none;
  EXPECT_EQ(residualSpread(none), 0.0);
}

TEST(HuberThreshold, KeepsItsBounds) {
  EXPECT_NEAR(huberThreshold(2.0, 9.0), 5.0, 1e-9);
  EXPECT_EQ(huberThreshold(100.0, 9.0), 9.0);
  EXPECT_GT(huberThreshold(0.0, 9.0), 0.3);  // 8-bit images are rounded by 0.3 grey levels
}

TEST(ResidualPrecision, IsTheInverseVarianceDownToWhatRoundingLeaves) {
  EXPECT_NEAR(residualPrecision(2.0), 0.25, 1e-9);
  EXPECT_TRUE(std::isfinite(residualPrecision(0.0)));
  EXPECT_EQ(residualPrecision(0.0), residualPrecision(0.1));
}

}  // namespace
}  // namespace mba_vo::residual_spread_test
