#include "mba_vo/odometry/input_guard.h"

#include <cmath>
#include <iomanip>
#include <numeric>
#include <sstream>

namespace mba_vo {
namespace {

constexpr double kSecondsPerNanosecond = 1e-9;
constexpr double kRestartJump = 1.0;             // [s]
constexpr std::size_t kRememberedIntervals = 8;  // averages the jitter of stamps
constexpr double kIntervalTolerance = 1.1;  // exposure over mean interval; a dark scene may use all of the interval

std::string seconds(std::int64_t nanoseconds) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(6) << kSecondsPerNanosecond * static_cast<double>(nanoseconds) << " s";
  return text.str();
}

}  // namespace

std::string InputGuard::problemOfExposure(double exposure) const {
  std::ostringstream text;
  if (!std::isfinite(exposure)) {
    text << "exposure " << exposure << " is not a number of seconds";
  } else if (exposure < 0.0) {
    text << "exposure " << exposure << " s is negative";
  } else if (!intervals_.empty()) {
    const double mean =
        std::accumulate(intervals_.begin(), intervals_.end(), 0.0) / static_cast<double>(intervals_.size());
    if (exposure > kIntervalTolerance * mean) {
      text << "exposure " << exposure << " s is longer than the frame interval of " << mean << " s";
    }
  }
  return text.str();
}

InputVerdict InputGuard::check(std::int64_t stamp_ns, std::optional<double> exposure) {
  InputVerdict verdict;
  if (last_stamp_ns_ && stamp_ns <= *last_stamp_ns_) {
    verdict.accepted = false;
    const std::int64_t back = *last_stamp_ns_ - stamp_ns;
    verdict.clock_restarted = kSecondsPerNanosecond * static_cast<double>(back) > kRestartJump;
    verdict.reason = back == 0
                         ? "stamp " + seconds(stamp_ns) + " repeats that of the previous image"
                         : "stamp " + seconds(stamp_ns) + " is " + seconds(back) + " before that of the previous image";
    return verdict;
  }
  if (last_stamp_ns_) {
    intervals_.push_back(kSecondsPerNanosecond * static_cast<double>(stamp_ns - *last_stamp_ns_));
    if (intervals_.size() > kRememberedIntervals) {
      intervals_.pop_front();
    }
  }
  last_stamp_ns_ = stamp_ns;
  verdict.exposure = exposure;
  if (exposure) {
    const std::string problem = problemOfExposure(*exposure);
    if (!problem.empty()) {
      verdict.exposure.reset();
      verdict.reason = problem + ", treated as unknown";
    }
  }
  return verdict;
}

void InputGuard::reset() {
  last_stamp_ns_.reset();
  intervals_.clear();
}

}  // namespace mba_vo
