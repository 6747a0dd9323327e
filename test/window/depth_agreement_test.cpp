#include "mba_vo/window/depth_agreement.h"

#include <cmath>

#include <gtest/gtest.h>

namespace mba_vo::depth_agreement_test {
namespace {

constexpr double kPrecision = 0.5;  // [1 / grey level^2]

TEST(MeasuredDepthTerm, DerivativesAreThoseOfTheCost) {
  const MeasuredDepth measured{0.5, 1e-4};
  for (const double d : {0.3, 0.47, 0.499, 0.5, 0.52, 0.9}) {
    constexpr double kStep = 1e-6;
    const double slope = (measuredDepthTerm(measured, d + kStep, kPrecision).cost -
                          measuredDepthTerm(measured, d - kStep, kPrecision).cost) /
                         (2.0 * kStep);
    const MeasuredDepthTerm term = measuredDepthTerm(measured, d, kPrecision);
    EXPECT_NEAR(2.0 * term.b, slope, 1e-4 * (1.0 + std::abs(slope))) << d;
    EXPECT_NEAR(term.b, term.H * (d - 0.5), 1e-9 * (1.0 + std::abs(term.b))) << d;
  }
  // Near the measurement a deviation of one sigma costs as much as the variance of one residual, far away hardly more.
  EXPECT_NEAR(measuredDepthTerm(measured, 0.501, kPrecision).cost, kPrecision * 25.0 * 0.01, 1e-3);
  EXPECT_LT(measuredDepthTerm(measured, 2.5, kPrecision).b, 0.2 * measuredDepthTerm(measured, 0.53, kPrecision).b);
  EXPECT_EQ(measuredDepthTerm({}, 0.7, kPrecision).cost, 0.0);
  EXPECT_EQ(measuredDepthTerm({}, 0.7, kPrecision).H, 0.0);
}

}  // namespace
}  // namespace mba_vo::depth_agreement_test
