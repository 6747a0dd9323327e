#include "mba_vo/io/row_time_search.h"

#include <cmath>

#include <gtest/gtest.h>

namespace mba_vo {
namespace {

TEST(FindRowTime, FindsTheMinimum) {
  constexpr double kLimit = 7e-5;  // [s]
  for (const double truth : {-6.1e-5, -2e-5, 0.0, 3e-6, 3.3e-5, 6.4e-5, 7e-5}) {
    int trials = 0;
    const auto residual = [&](double row_time) {
      ++trials;
      EXPECT_LE(std::abs(row_time), 1.001 * kLimit);
      const double off = (row_time - truth) / kLimit;
      return 5.0 + 3.0 * off * off / (1.0 + std::abs(off));  // far away, images disagree about equally badly
    };
    EXPECT_NEAR(findRowTime(kLimit, residual).row_time, truth, 0.03 * kLimit) << truth;
    EXPECT_LE(trials, 11);
  }
}

TEST(FindRowTime, StaysWhereItBeganIfNothingTells) {
  EXPECT_EQ(findRowTime(7e-5, [](double) { return 4.0; }).row_time, 0.0);
}

}  // namespace
}  // namespace mba_vo
