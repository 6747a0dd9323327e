#include "mba_vo/mapping/point_budget.h"

#include <gtest/gtest.h>

namespace mba_vo::point_budget_test {
namespace {

constexpr int kMost = 1000;

TEST(PointBudget, IsAllThatIsConfiguredWhileTheWindowKeepsUp) {
  PointBudget budget(kMost);
  for (int i = 0; i < 10; ++i) budget.keepUp();
  EXPECT_EQ(budget.points(), kMost);
}

TEST(PointBudget, FallsFastAndRisesSlowly) {
  PointBudget budget(kMost);
  budget.fallBehind();
  const int fallen = budget.points();
  EXPECT_LT(fallen, 0.8 * kMost);
  budget.keepUp();
  EXPECT_GT(budget.points(), fallen);
  EXPECT_LT(budget.points(), 0.8 * kMost) << "one keyframe in time says little";
  for (int i = 0; i < 20; ++i) budget.keepUp();
  EXPECT_EQ(budget.points(), kMost);
}

TEST(PointBudget, NeverFallsToNothing) {
  PointBudget budget(kMost);
  for (int i = 0; i < 100; ++i) budget.fallBehind();
  EXPECT_EQ(budget.points(), 400);
}

}  // namespace
}  // namespace mba_vo::point_budget_test
