#include "mba_vo/mapping/place_between.h"

#include <gtest/gtest.h>

#include "support/random.h"

namespace mba_vo {
namespace {

constexpr std::int64_t kInterval = 74'000'000;  // [ns]

double seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

TEST(PlaceBetween, IsExactForConstantVelocityAndAtTheEnds) {
  test::Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const SE3 start = random.pose(1.0, 1.0);
    const Vector6 v = random.tangent(1.0, 3.0);
    const auto at = [&](std::int64_t ns) { return Waypoint{ns, start * SE3::exp(seconds(ns) * v), v}; };
    for (const std::int64_t ns : {0L, 20'000'000L, 37'000'000L, kInterval}) {
      const SE3 place = placeBetween(at(0), at(kInterval), ns);
      EXPECT_LT((place.inverse() * at(ns).T_map_camera).log().norm(), 1e-12);
    }
  }
}

// A body that turns by 5 degrees an image and changes that by half: integrated in small steps.
TEST(PlaceBetween, FollowsAConstantAcceleration) {
  const Vector6 v = (Vector6() << 0.4, -0.2, 0.6, 2.3, 0.5, -0.4).finished();
  const Vector6 a = (Vector6() << 3.0, 1.0, -2.0, 16.0, -10.0, 5.0).finished();
  constexpr std::int64_t kStep = 10'000;  // [ns]
  Waypoint before{0, SE3(), v};
  Waypoint after = before;
  SE3 middle;
  for (std::int64_t ns = 0; ns < kInterval; ns += kStep) {
    if (ns == kInterval / 2) middle = after.T_map_camera;
    after.T_map_camera = after.T_map_camera * SE3::exp(seconds(kStep) * (v + seconds(ns + kStep / 2) * a));
  }
  after.mid_exposure_ns = kInterval;
  after.velocity = v + seconds(kInterval) * a;
  const Vector6 error = (middle.inverse() * placeBetween(before, after, kInterval / 2)).log();
  EXPECT_LT(error.head<3>().norm(), 3e-5);  // constant velocity: 4e-3 m
  EXPECT_LT(error.tail<3>().norm(), 3e-4);  // constant velocity: 0.013 rad
  // With an error of the velocities of 0.1 m/s on both sides, an eighth of the interval of it.
  before.velocity(0) += 0.1;
  after.velocity(0) -= 0.1;
  const Vector6 disturbed = (middle.inverse() * placeBetween(before, after, kInterval / 2)).log();
  EXPECT_NEAR(disturbed(0) - error(0), 0.25 * seconds(kInterval) * 0.1, 2e-4);
}

}  // namespace
}  // namespace mba_vo
