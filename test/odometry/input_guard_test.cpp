#include "mba_vo/odometry/input_guard.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mba_vo::input_guard_test {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kMillisecond = 1000000;  // [ns]
constexpr std::int64_t kStart = 1305031453359684000;

TEST(InputGuard, AcceptsARegularSequence) {
  InputGuard guard;
  for (int i = 0; i < 20; ++i) {
    const InputVerdict verdict = guard.check(kStart + 30 * i * kMillisecond, 0.02);
    EXPECT_TRUE(verdict.accepted);
    EXPECT_EQ(verdict.reason, "");
    EXPECT_EQ(verdict.exposure, 0.02);
  }
}

TEST(InputGuard, UnknownAndZeroExposureAreKept) {
  InputGuard guard;
  EXPECT_FALSE(guard.check(kStart, std::nullopt).exposure.has_value());
  EXPECT_EQ(guard.check(kStart + kMillisecond, 0.0).exposure, 0.0);
}

TEST(InputGuard, RejectsRepeatedAndBackwardStampsAndRecovers) {
  InputGuard guard;
  guard.check(kStart, 0.02);
  const InputVerdict repeated = guard.check(kStart, 0.02);
  EXPECT_FALSE(repeated.accepted);
  EXPECT_THAT(repeated.reason, HasSubstr("1305031453.359684 s repeats"));
  const InputVerdict backwards = guard.check(kStart - 50 * kMillisecond, 0.02);
  EXPECT_FALSE(backwards.accepted);
  EXPECT_FALSE(backwards.clock_restarted);
  EXPECT_THAT(backwards.reason, HasSubstr("0.050000 s before"));
  EXPECT_TRUE(guard.check(kStart + 30 * kMillisecond, 0.02).accepted);
}

TEST(InputGuard, TellsARestartedClock) {
  InputGuard guard;
  guard.check(kStart, std::nullopt);
  const InputVerdict verdict = guard.check(kStart - 5000 * kMillisecond, std::nullopt);
  EXPECT_FALSE(verdict.accepted);
  EXPECT_TRUE(verdict.clock_restarted);
  guard.reset();
  EXPECT_TRUE(guard.check(kStart - 5000 * kMillisecond, std::nullopt).accepted);
}

TEST(InputGuard, ImpossibleExposureIsUnknownButTheImageIsKept) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double exposure : {-0.02, std::nan(""), infinity, -infinity}) {
    InputGuard guard;
    const InputVerdict verdict = guard.check(kStart, exposure);
    EXPECT_TRUE(verdict.accepted);
    EXPECT_FALSE(verdict.exposure.has_value());
    EXPECT_THAT(verdict.reason, HasSubstr("treated as unknown"));
  }
}

TEST(InputGuard, ExposureLongerThanTheFrameIntervalIsUnknown) {
  InputGuard guard;
  guard.check(kStart, 0.02);
  EXPECT_TRUE(guard.check(kStart + 30 * kMillisecond, 0.03).exposure.has_value());
  const InputVerdict verdict = guard.check(kStart + 60 * kMillisecond, 0.04);
  EXPECT_TRUE(verdict.accepted);
  EXPECT_FALSE(verdict.exposure.has_value());
  EXPECT_THAT(verdict.reason, HasSubstr("exposure 0.04 s is longer than the frame interval of 0.03 s"));
}

TEST(InputGuard, JitterOfOneStampDoesNotCondemnALongExposure) {
  InputGuard guard;
  for (int i = 0; i < 8; ++i) {
    guard.check(kStart + 33 * i * kMillisecond, 0.032);
  }
  EXPECT_TRUE(guard.check(kStart + 33 * 7 * kMillisecond + 25 * kMillisecond, 0.032).exposure.has_value());
}

}  // namespace
}  // namespace mba_vo::input_guard_test
