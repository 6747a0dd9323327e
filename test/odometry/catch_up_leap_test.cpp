#include "mba_vo/odometry/catch_up_leap.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace mba_vo::catch_up_leap_test {
namespace {

constexpr double kRate = 30.0;  // images a second
constexpr std::size_t kMany = 50;

std::int64_t at(double seconds) { return static_cast<std::int64_t>(1e9 * seconds); }

struct CaughtUp {
  double seconds = 0.0;      // until nothing waited
  std::size_t left_out = 0;  // of the frames that waited
};

/// From `waiting` frames on, if that many can be tried a second, and no leap over more than `reach` succeeds.
CaughtUp catchUp(double tried_per_second, std::size_t waiting, std::size_t reach) {
  CatchUpLeap leap;
  CaughtUp result;
  int images = 0;  // that came meanwhile
  while (waiting > 0 && result.seconds < 10.0) {
    const std::size_t over = leap.over(waiting, at(images / kRate));
    result.seconds += 1.0 / tried_per_second;
    if (over <= reach) {
      waiting -= over + 1;
      result.left_out += over;
    } else {
      leap.fail(over);
    }
    if (waiting == 0) break;
    for (; images < kRate * result.seconds; ++images) ++waiting;
  }
  return result;
}

TEST(CatchUpLeap, AMachineThatKeepsUpLeavesNothingOut) { EXPECT_EQ(catchUp(120.0, 5, kMany).left_out, 0U); }

TEST(CatchUpLeap, WhereNoTimePassesNoFrameIsLeaptOver) {
  CatchUpLeap leap;
  for (std::size_t waiting = 6; waiting > 0; --waiting) EXPECT_EQ(leap.over(waiting, 5), 0U);
  EXPECT_FALSE(leap.isPressed());
}

TEST(CatchUpLeap, HoweverSlowTheMachineItComesToAnEnd) {
  for (const double tried_per_second : {120.0, 40.0, 25.0, 15.0, 10.0}) {
    EXPECT_LT(catchUp(tried_per_second, kMany, kMany).seconds, 0.2) << tried_per_second;
    EXPECT_LT(catchUp(tried_per_second, kMany, 8).seconds, 2.0) << tried_per_second;
  }
}

TEST(CatchUpLeap, AfterAFailureItTriesHalfAsFarUntilThereIsMoreToSee) {
  CatchUpLeap leap;
  leap.hurry();
  EXPECT_EQ(leap.over(9, 0), 8U);
  EXPECT_TRUE(leap.isPressed());
  leap.fail(8);
  EXPECT_EQ(leap.over(20, 0), 4U);
  leap.fail(4);
  leap.fail(2);
  leap.fail(1);
  EXPECT_EQ(leap.over(20, 0), 0U) << "the next one";
  leap.lookFurther();
  EXPECT_EQ(leap.over(20, 0), 19U);
}

TEST(CatchUpLeap, BeginsAnewWhenNothingWaitsAnyMore) {
  CatchUpLeap leap;
  EXPECT_EQ(leap.over(3, at(0.0)), 0U);
  EXPECT_EQ(leap.over(3, at(0.05)), 0U) << "patience";
  EXPECT_EQ(leap.over(3, at(0.15)), 2U);
  EXPECT_TRUE(leap.isPressed());
  leap.reset();
  EXPECT_FALSE(leap.isPressed());
  EXPECT_EQ(leap.over(3, at(3.0)), 0U);
  EXPECT_EQ(leap.over(kMany, at(3.0)), 0U);
  leap.reset();
  EXPECT_EQ(leap.over(kMany, at(6.0)), kMany - 1) << "so many waited when it began";
}

TEST(CatchUpLeap, WhatIsReachedIsWhereItLooksFartherFrom) {
  CatchUpLeap leap;
  leap.hurry();
  leap.fail(leap.over(9, 0));
  leap.fail(leap.over(9, 0));
  EXPECT_EQ(leap.over(9, 0), 2U);
  leap.reach(2);
  EXPECT_EQ(leap.over(9, 0), 5U);
}

TEST(CatchUpLeap, ItIsHopelessWhereNotEvenTheNextOnesCanBeAligned) {
  CatchUpLeap leap;
  for (int i = 0; i < 5; ++i) leap.lose();
  EXPECT_FALSE(leap.isHopeless()) << "there is time";
  leap.hurry();
  leap.over(9, 0);
  EXPECT_TRUE(leap.isHopeless());
  leap.reach(0);
  leap.lose();
  leap.lose();
  EXPECT_FALSE(leap.isHopeless());
}

}  // namespace
}  // namespace mba_vo::catch_up_leap_test
