#include "mba_vo/capture/buffer_stamp.h"

#include <gtest/gtest.h>

#include "capture/fake_clock.h"

namespace mba_vo::buffer_stamp_test {
namespace {

v4l2_buffer bufferOf(std::int64_t stamp_ns, std::uint32_t flags) {
  v4l2_buffer buffer{};
  buffer.timestamp = {stamp_ns / 1'000'000'000, stamp_ns / 1'000 % 1'000'000};
  buffer.flags = flags;
  return buffer;
}

constexpr std::uint32_t kStart = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
constexpr std::uint32_t kEnd = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_EOF;
constexpr std::int64_t kAge = 20'000'000;  // [ns]

TEST(BufferStamp, MonotonicStampsBecomeWallTime) {
  FakeClock clock;
  const BufferStamp stamp = stampOfBuffer(bufferOf(clock.monotonicNow() - kAge, kStart), clock);
  EXPECT_EQ(stamp.wall_ns, clock.wallNow() - kAge);
  EXPECT_EQ(stamp.clock, StampClock::kMonotonic);
  EXPECT_EQ(stamp.moment, StampMoment::kStartOfExposure);
  EXPECT_EQ(stampOfBuffer(bufferOf(clock.monotonicNow() - kAge, kEnd), clock).moment, StampMoment::kEndOfReadOut);
}

TEST(BufferStamp, FollowsAWallClockThatIsSet) {
  FakeClock clock;
  clock.setWallMinusMonotonic(1'500'000'000'000'000'000);
  EXPECT_EQ(stampOfBuffer(bufferOf(clock.monotonicNow() - kAge, kStart), clock).wall_ns, clock.wallNow() - kAge);
}

TEST(BufferStamp, WallStampsOfADriverThatSaysMonotonic) {
  FakeClock clock;
  const BufferStamp stamp = stampOfBuffer(bufferOf(clock.wallNow() - kAge, kStart), clock);
  EXPECT_EQ(stamp.wall_ns, clock.wallNow() - kAge);
  EXPECT_EQ(stamp.clock, StampClock::kWall);
}

TEST(BufferStamp, ImpossibleStampsGiveWayToTheTimeOfArrival) {
  FakeClock clock;
  for (const std::int64_t wrong :
       {std::int64_t{0}, clock.monotonicNow() + 1'000'000'000, clock.monotonicNow() - 60'000'000'000}) {
    const BufferStamp stamp = stampOfBuffer(bufferOf(wrong, kStart), clock);
    EXPECT_EQ(stamp.wall_ns, clock.wallNow());
    EXPECT_EQ(stamp.clock, StampClock::kArrival);
    EXPECT_EQ(stamp.moment, StampMoment::kEndOfReadOut);
  }
}

TEST(BufferStamp, MiddleOfTheExposureOfTheMiddleRow) {
  // First row exposed 0..10 ms, last row 20..30 ms: the middle row at 10..20 ms.
  BufferStamp stamp;
  stamp.moment = StampMoment::kStartOfExposure;
  EXPECT_EQ(midExposureOf(stamp, 0.01, 0.02), 15'000'000);
  stamp.moment = StampMoment::kEndOfReadOut;
  stamp.wall_ns = 30'000'000;
  EXPECT_EQ(midExposureOf(stamp, 0.01, 0.02), 15'000'000);
  EXPECT_EQ(midExposureOf(stamp, std::nullopt, 0.0), 30'000'000);
}

}  // namespace
}  // namespace mba_vo::buffer_stamp_test
