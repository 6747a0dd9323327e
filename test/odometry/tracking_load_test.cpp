#include "mba_vo/odometry/tracking_load.h"

#include <gtest/gtest.h>

namespace mba_vo::tracking_load_test {
namespace {

/// Images until it is too high, of which every `period`-th finds others waiting; 1000 = never.
int imagesUntilTooHigh(TrackingLoad& load, int period) {
  int image = 0;
  while (image < 1000 && !load.isTooHigh(image % period == 0)) ++image;
  return image;
}

TEST(TrackingLoad, IsTooHighWithinHalfASecondWhereAllImagesWait) {
  TrackingLoad load;
  EXPECT_LT(imagesUntilTooHigh(load, 1), 15);
  EXPECT_GT(imagesUntilTooHigh(load, 1), 7) << "what is done about it needs time to show";
}

TEST(TrackingLoad, ABurstNowAndThenDoesNoHarm) {
  TrackingLoad load;
  EXPECT_EQ(imagesUntilTooHigh(load, 5), 1000);
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(load.isTooHigh(true));
}

}  // namespace
}  // namespace mba_vo::tracking_load_test
