#include "mba_vo/tracking/exposure_history.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

namespace mba_vo::exposure_history_test {
namespace {

TEST(ExposureHistory, IsAStraightLineOfTheLogarithmBetweenItsEntries) {
  const ExposureHistory history({{1.0, std::log(0.01), 5.0}, {2.0, std::log(0.02), 5.0}});
  EXPECT_NEAR(history.exposureAt(1.0), 0.01, 1e-12);
  EXPECT_NEAR(history.exposureAt(1.5), 0.01 * std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(history.exposureAt(2.0), 0.02, 1e-12);
}

TEST(ExposureHistory, GoesOnAtItsRateForAWhile) {
  const ExposureHistory history({{1.0, std::log(0.01), -1.0}, {2.0, std::log(0.02), 1.0}});
  EXPECT_NEAR(history.exposureAt(0.9), 0.01 * std::exp(0.1), 1e-12);
  EXPECT_NEAR(history.exposureAt(2.1), 0.02 * std::exp(0.1), 1e-12);
  EXPECT_EQ(history.exposureAt(-5.0), history.exposureAt(0.5)) << "a rate is not believed for long";
  EXPECT_EQ(history.exposureAt(9.0), history.exposureAt(2.5));
}

TEST(ExposureHistory, NeedsAnEntry) { EXPECT_THROW(ExposureHistory({}), std::invalid_argument); }

}  // namespace
}  // namespace mba_vo::exposure_history_test
