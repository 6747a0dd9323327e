#include "mba_vo/capture/buffer_stamp.h"

#include <cmath>

namespace mba_vo {
namespace {

constexpr std::int64_t kOldest = 10'000'000'000;  // an image has not been waiting for longer than this [ns]
constexpr std::int64_t kFuture = 1'000'000;       // the stamp may be rounded [ns]

bool plausible(std::int64_t age) { return age > -kFuture && age < kOldest; }

std::int64_t nanoseconds(const timeval& time) {
  return std::int64_t{1'000'000'000} * time.tv_sec + std::int64_t{1'000} * time.tv_usec;
}

}  // namespace

BufferStamp stampOfBuffer(const v4l2_buffer& buffer, const Clock& clock) {
  const std::int64_t stamp = nanoseconds(buffer.timestamp);
  const std::int64_t offset = wallMinusMonotonic(clock);
  const std::int64_t wall_now = clock.wallNow();
  BufferStamp result;
  if ((buffer.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE) {
    result.moment = StampMoment::kStartOfExposure;
  }
  // Not by the flag alone: uvcvideo says monotonic also where its parameter `clock` has it use the wall clock.
  if (plausible(wall_now - offset - stamp)) {
    result.clock = StampClock::kMonotonic;
    result.wall_ns = stamp + offset;
  } else if (plausible(wall_now - stamp)) {
    result.clock = StampClock::kWall;
    result.wall_ns = stamp;
  } else {
    result = BufferStamp();
    result.wall_ns = wall_now;
  }
  return result;
}

std::int64_t midExposureOf(const BufferStamp& stamp, std::optional<double> exposure, double read_out) {
  const std::int64_t half = std::llround(0.5e9 * (exposure.value_or(0.0) + read_out));
  return stamp.moment == StampMoment::kStartOfExposure ? stamp.wall_ns + half : stamp.wall_ns - half;
}

const char* toString(StampClock clock) {
  switch (clock) {
    case StampClock::kMonotonic:
      return "monotonic clock";
    case StampClock::kWall:
      return "wall clock";
    default:
      return "arrival, as the driver tells none";
  }
}

const char* toString(StampMoment moment) {
  return moment == StampMoment::kStartOfExposure ? "start of exposure" : "end of read-out";
}

}  // namespace mba_vo
