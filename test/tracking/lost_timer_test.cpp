#include "mba_vo/tracking/lost_timer.h"

#include <gtest/gtest.h>

namespace mba_vo::lost_timer_test {
namespace {

constexpr std::int64_t kTenth = 100000000;  // of a second [ns]

TEST(LostTimer, CountsOnlyTheTimeOfImagesThatShowSomething) {
  LostTimer clock;
  EXPECT_FALSE(clock.lost());
  clock.lose(0, false);
  EXPECT_TRUE(clock.lost());
  EXPECT_EQ(clock.seconds(), 0.0);
  clock.lose(kTenth, false);
  EXPECT_NEAR(clock.seconds(), 0.1, 1e-12);
  for (int i = 2; i <= 30; ++i) clock.lose(i * kTenth, true);
  EXPECT_NEAR(clock.seconds(), 0.1, 1e-12);
  clock.lose(31 * kTenth, false);
  EXPECT_NEAR(clock.seconds(), 0.2, 1e-12);
  clock.lose(5 * kTenth, false);  // tracked again, in vain
  EXPECT_NEAR(clock.seconds(), 0.2, 1e-12);
  clock.find();
  EXPECT_FALSE(clock.lost());
  EXPECT_EQ(clock.seconds(), 0.0);
}

}  // namespace
}  // namespace mba_vo::lost_timer_test
