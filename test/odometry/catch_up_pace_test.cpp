#include "mba_vo/odometry/catch_up_pace.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace mba_vo {
namespace {

constexpr double kRate = 30.0;  // images a second

/// Seconds of images until nothing waits, if that many can be tracked a second; `left_out`: of those that waited.
double catchUp(double tracked_per_second, double waiting, double* left_out) {
  CatchUpPace pace;
  *left_out = 0.0;
  double seconds = 0.0;
  for (; waiting > 0.0 && seconds < 10.0; seconds += 1.0 / tracked_per_second) {
    // Images come at their rate, whole ones.
    const auto newest_ns = static_cast<std::int64_t>(1e9 / kRate * static_cast<int>(kRate * seconds));
    const double out = std::min(
        waiting - 1.0, static_cast<double>(pace.framesToLeaveOut(static_cast<std::size_t>(waiting), newest_ns)));
    *left_out += std::max(0.0, out);
    waiting += kRate / tracked_per_second - 1.0 - std::max(0.0, out);
  }
  return seconds;
}

TEST(CatchUpPace, AFastMachineLeavesNothingOut) {
  double left_out = 0.0;
  EXPECT_LT(catchUp(100.0, 50.0, &left_out), 0.8);
  EXPECT_EQ(left_out, 0.0);
}

TEST(CatchUpPace, WhereNoTimePassesNothingIsLeftOut) {
  CatchUpPace pace;
  for (std::size_t waiting = 1000; waiting > 0; --waiting) EXPECT_EQ(pace.framesToLeaveOut(waiting, 5), 0U);
}

TEST(CatchUpPace, HoweverSlowTheMachineItComesToAnEnd) {
  for (const double tracked_per_second : {70.0, 40.0, 31.0, 25.0, 15.0, 8.0}) {
    double left_out = 0.0;
    EXPECT_LT(catchUp(tracked_per_second, 50.0, &left_out), 1.3) << tracked_per_second;
    EXPECT_GT(left_out, 0.0) << tracked_per_second;
  }
}

TEST(CatchUpPace, BeginsAnewWhenNothingWaitsAnyMore) {
  CatchUpPace pace;
  pace.framesToLeaveOut(50, 0);
  pace.framesToLeaveOut(50, 900000000);
  EXPECT_GT(pace.framesToLeaveOut(50, 950000000), 10U);
  pace.reset();
  EXPECT_EQ(pace.framesToLeaveOut(50, 1000000000), 0U);
  EXPECT_EQ(pace.framesToLeaveOut(50, 1000000000), 0U);
}

}  // namespace
}  // namespace mba_vo
