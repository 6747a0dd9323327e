#include "mba_vo/image/stamp_smoother.h"

#include <algorithm>
#include <cmath>

namespace mba_vo {
namespace {

// Stamps of cameras that count in coarse units (32 and 36 ms by turns, as of a Kinect) differ by 12 %.
constexpr double kTolerance = 0.15;           // of an interval
constexpr int kMostDropped = 3;               // intervals in the place of one
constexpr std::size_t kJudgedIntervals = 16;  // so many tell whether stamps jitter,
constexpr std::ptrdiff_t kJitter = 4;         // if so many of them have no explanation; one hiccup leaves three
constexpr std::ptrdiff_t kNoJitter = 0;       // and that they no longer do
constexpr std::size_t kFittedStamps = 32;     // a line through them leaves a third of the jitter at its end
constexpr std::size_t kFewestStamps = 8;
constexpr double kOffLine = 0.5;     // [periods] from the line
constexpr int kMostOffLine = 4;      // in a row: it is not jitter, but frames were dropped or the rate is new
constexpr double kLeastStep = 0.25;  // [periods] between two images

/// A frame follows the last one after a period, or after several, if frames were dropped now or then.
bool isExplained(double interval, double earlier) {
  for (int n = 1; n <= kMostDropped; ++n) {
    if (std::abs(interval - n * earlier) < kTolerance * n * earlier) return true;
    if (std::abs(n * interval - earlier) < kTolerance * earlier) return true;
  }
  return false;
}

}  // namespace

std::int64_t StampSmoother::smooth(std::int64_t stamp_ns, std::uint64_t images) {
  if (!stamps_.empty()) judge(static_cast<double>(stamp_ns - stamps_.back().ns));
  const double index = stamps_.empty() ? 0.0 : stamps_.back().index + static_cast<double>(images);
  stamps_.push_back({index, stamp_ns});
  if (stamps_.size() > kFittedStamps) stamps_.pop_front();
  std::int64_t smooth_ns = stamp_ns;
  std::int64_t least_step = 1;  // [ns]
  if (jitters_) {
    followCamera();
    if (stamps_.size() >= kFewestStamps) {
      const Line line = fit();
      smooth_ns -= std::llround(line.offset);
      least_step = std::max<std::int64_t>(least_step, std::llround(kLeastStep * line.period));
    }
  }
  if (last_ns_) smooth_ns = std::max(smooth_ns, *last_ns_ + least_step);
  last_ns_ = smooth_ns;
  return smooth_ns;
}

/// A new rate leaves one interval without an explanation, and dropped frames leave none.
void StampSmoother::judge(double interval) {
  const auto explains = [&](double earlier) { return isExplained(interval, earlier); };
  if (!intervals_.empty()) unexplained_.push_back(std::none_of(intervals_.begin(), intervals_.end(), explains));
  intervals_.push_back(interval);
  if (intervals_.size() > 2) intervals_.pop_front();
  if (unexplained_.size() > kJudgedIntervals) unexplained_.pop_front();
  const auto count = std::count(unexplained_.begin(), unexplained_.end(), true);
  jitters_ = count >= kJitter || (jitters_ && count > kNoJitter);
}

/// By least squares.
StampSmoother::Line StampSmoother::fit() const {
  const Stamp& newest = stamps_.back();
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (const Stamp& stamp : stamps_) {
    const double index = stamp.index - newest.index;
    const auto ns = static_cast<double>(stamp.ns - newest.ns);
    n += 1.0;
    x += index;
    y += ns;
    xx += index * index;
    xy += index * ns;
  }
  const double period = (n * xy - x * y) / (n * xx - x * x);
  return {-(y - period * x) / n, period};
}

/// Forgets stamps that the newest ones no longer agree with.
void StampSmoother::followCamera() {
  if (stamps_.size() < kFewestStamps) return;
  const Line line = fit();
  const bool far = std::abs(line.offset) > kOffLine * line.period;
  const int side = line.offset > 0.0 ? 1 : -1;
  off_ = !far ? 0 : off_ * side > 0 ? off_ + side : side;
  if (std::abs(off_) < kMostOffLine) return;
  stamps_.erase(stamps_.begin(), stamps_.end() - kMostOffLine);
  off_ = 0;
}

}  // namespace mba_vo
