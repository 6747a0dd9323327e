#include "mba_vo/geometry/exposure_trajectory.h"

#include <gtest/gtest.h>

#include "support/random.h"

namespace mba_vo::exposure_trajectory_test {
namespace {

TEST(ExposureTrajectory, DelayedFollowsTheSameCurve) {
  test::Random random(1);
  for (int i = 0; i < 50; ++i) {
    const ExposureTrajectory trajectory{random.pose(1.0, 1.0), random.tangent(0.7, 1.5), 0.02,
                                        random.tangent(5.0, 10.0)};
    for (const double delay : {-0.015, 0.01}) {
      const ExposureTrajectory delayed = trajectory.delayed(delay);
      EXPECT_DOUBLE_EQ(delayed.exposure, trajectory.exposure);
      EXPECT_LT((delayed.T_reference_mid.inverse() * trajectory.at(delay)).log().norm(), 1e-12);
      // Without acceleration the ends would be off by its share of delay times half the exposure, 1.5e-3.
      EXPECT_LT((delayed.start().inverse() * trajectory.at(delay - 0.01)).log().norm(), 3e-5);
      EXPECT_LT((delayed.end().inverse() * trajectory.at(delay + 0.01)).log().norm(), 3e-5);
    }
  }
}

}  // namespace
}  // namespace mba_vo::exposure_trajectory_test
