#pragma once

#include <cstdint>
#include <optional>

#include <linux/videodev2.h>

#include "mba_vo/capture/clock.h"

namespace mba_vo {

enum class StampClock { kMonotonic, kWall, kArrival };       // what the driver stamped by; kArrival: it did not
enum class StampMoment { kStartOfExposure, kEndOfReadOut };  // of the first row; of the last row

/// When the driver says an image was taken.
struct BufferStamp {
  std::int64_t wall_ns = 0;  // wall clock [ns since 1970]
  StampClock clock = StampClock::kArrival;
  StampMoment moment = StampMoment::kEndOfReadOut;
};

/// Stamp of a buffer that has just been taken from the driver, turned into wall time. A stamp that lies in the future,
/// or more than some seconds back, is of neither clock: the time of arrival is taken, as if the read-out ended then.
BufferStamp stampOfBuffer(const v4l2_buffer& buffer, const Clock& clock);

/// Middle of the exposure of the middle row [ns]. `read_out`: from the first row to the last [s], 0 for a global
/// shutter. With an unknown exposure that of an instantaneous one.
std::int64_t midExposureOf(const BufferStamp& stamp, std::optional<double> exposure, double read_out);

/// "start of exposure, monotonic clock", for the user.
const char* toString(StampClock clock);
const char* toString(StampMoment moment);

}  // namespace mba_vo
