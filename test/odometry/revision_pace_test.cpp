#include "mba_vo/odometry/revision_pace.h"

#include <gtest/gtest.h>

namespace mba_vo::revision_pace_test {
namespace {

constexpr std::int64_t kInterval_ns = 33000000;

/// Images until it is too slow, where of 20 waiting frames and one more with each image, so many are tracked per image;
/// -1 if none is left before.
int imagesUntilTooSlow(RevisionPace& pace, double frames_per_image) {
  pace.begin();
  double waiting = 20.0;
  for (int image = 0; image < 100 && waiting >= 1.0; ++image) {
    if (pace.isTooSlow(static_cast<std::size_t>(waiting), image * kInterval_ns)) return image;
    waiting += 1.0 - frames_per_image;
  }
  return -1;
}

TEST(RevisionPace, WhereWaitingFramesBecomeFewerThereIsTime) {
  RevisionPace pace;
  EXPECT_EQ(imagesUntilTooSlow(pace, 2.0), -1);
  EXPECT_EQ(imagesUntilTooSlow(pace, 1.5), -1);
  EXPECT_FALSE(pace.rests(0));
}

TEST(RevisionPace, WhereTheyDoNotItIsTooSlowAndRestsForASecond) {
  RevisionPace pace;
  const int images = imagesUntilTooSlow(pace, 1.0);
  EXPECT_EQ(images, 3);
  EXPECT_TRUE(pace.rests((images + 29) * kInterval_ns));
  EXPECT_FALSE(pace.rests((images + 31) * kInterval_ns));
  EXPECT_EQ(imagesUntilTooSlow(pace, 0.5), 3) << "another try begins anew";
  pace.reset();
  EXPECT_FALSE(pace.rests(0));
}

}  // namespace
}  // namespace mba_vo::revision_pace_test
