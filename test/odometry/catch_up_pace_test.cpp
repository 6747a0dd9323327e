#include "mba_vo/odometry/catch_up_pace.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace mba_vo::catch_up_pace_test {
namespace {

constexpr double kRate = 30.0;  // images a second

struct CaughtUp {
  double seconds = 0.0;  // until nothing waited
  int left_out = 0;      // of the frames that waited
};

/// From `waiting` frames on, if that many can be tracked a second.
CaughtUp catchUp(double tracked_per_second, int waiting) {
  CatchUpPace pace;
  CaughtUp result;
  int images = 0;  // that came meanwhile
  for (int tracked = 1; result.seconds < 10.0; ++tracked) {
    const auto newest_ns = static_cast<std::int64_t>(1e9 / kRate * images);
    const auto out = static_cast<int>(pace.framesToLeaveOut(static_cast<std::size_t>(waiting), newest_ns));
    result.left_out += out;
    result.seconds = tracked / tracked_per_second;
    waiting -= out + 1;
    if (waiting <= 0) break;
    for (; images < kRate * result.seconds; ++images) ++waiting;
  }
  return result;
}

TEST(CatchUpPace, AFastMachineLeavesNothingOut) {
  const CaughtUp fast = catchUp(120.0, 50);
  EXPECT_LT(fast.seconds, 0.8);
  EXPECT_EQ(fast.left_out, 0);
}

TEST(CatchUpPace, WhereNoTimePassesNothingIsLeftOut) {
  CatchUpPace pace;
  for (std::size_t waiting = 1000; waiting > 0; --waiting) EXPECT_EQ(pace.framesToLeaveOut(waiting, 5), 0U);
}

TEST(CatchUpPace, HoweverSlowTheMachineItComesToAnEnd) {
  for (const double tracked_per_second : {120.0, 70.0, 40.0, 31.0, 25.0, 15.0, 8.0}) {
    const CaughtUp slow = catchUp(tracked_per_second, 50);
    EXPECT_LT(slow.seconds, 2.5) << tracked_per_second;
    EXPECT_EQ(slow.left_out > 0, tracked_per_second < 2.0 * kRate) << tracked_per_second;
  }
}

TEST(CatchUpPace, BeginsAnewWhenNothingWaitsAnyMore) {
  CatchUpPace pace;
  pace.framesToLeaveOut(50, 0);
  pace.framesToLeaveOut(50, 1900000000);
  EXPECT_TRUE(pace.isPressed());
  EXPECT_EQ(pace.framesToLeaveOut(50, 1950000000), 2U);
  EXPECT_GT(pace.framesToLeaveOut(50, 2050000000), 10U) << "too late for half measures";
  pace.reset();
  EXPECT_FALSE(pace.isPressed());
  EXPECT_EQ(pace.framesToLeaveOut(50, 3000000000), 0U);
  EXPECT_EQ(pace.framesToLeaveOut(50, 3000000000), 0U);
}

}  // namespace
}  // namespace mba_vo::catch_up_pace_test
