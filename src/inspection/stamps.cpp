#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "mba_vo/inspection/judgements.h"
#include "wording.h"

namespace mba_vo {
namespace {

constexpr double kRestart = 1.0;       // [s] back: taken for a new start, as by the odometry
constexpr double kMissed = 1.6;        // intervals from which on images are missing in between
constexpr double kLongGap = 0.2;       // [s] and
constexpr double kGapIntervals = 3.0;  // so many intervals: the camera may be anywhere
constexpr double kJitter = 0.15;       // of the interval; from there on the odometry smoothes
constexpr double kLowRate = 8.0;       // [Hz]
constexpr std::size_t kFew = 30;       // images

double seconds(std::int64_t nanoseconds) { return 1e-9 * static_cast<double>(nanoseconds); }

struct Counts {
  std::size_t zero = 0;
  std::size_t repeated = 0;
  std::size_t backwards = 0;
  std::size_t restarts = 0;
  double furthest_back = 0.0;     // [s]
  std::vector<double> intervals;  // [s], positive
  std::size_t missing = 0;
  std::size_t gaps = 0;
  double longest = 0.0;        // [s]
  double longest_after = 0.0;  // [s after the first image]
};

Counts countStamps(const std::vector<ImageFacts>& images, double interval) {
  Counts counts;
  std::optional<std::int64_t> last;
  for (const ImageFacts& image : images) {
    const std::int64_t stamp = image.stamp_ns;
    if (stamp == 0 && last) {  // a clock may begin with 0
      ++counts.zero;
      continue;
    }
    const double step = last ? seconds(stamp - *last) : 0.0;
    if (last && step <= 0.0 && step >= -kRestart) {
      ++(step == 0.0 ? counts.repeated : counts.backwards);
      counts.furthest_back = std::max(counts.furthest_back, -step);
      continue;  // as the odometry, which rejects them
    }
    if (step < 0.0) ++counts.restarts;
    if (step > 0.0) {
      counts.intervals.push_back(step);
      if (interval > 0.0 && step > kMissed * interval)
        counts.missing += static_cast<std::size_t>(std::lround(step / interval) - 1);
      if (step > std::max(kLongGap, kGapIntervals * interval)) ++counts.gaps;
      if (step > counts.longest) {
        counts.longest = step;
        counts.longest_after = seconds(*last - images.front().stamp_ns);
      }
    }
    last = stamp;
  }
  return counts;
}

/// Scatter of the intervals of which none is missing, over the interval. 0 where they are too few.
double jitterOf(const std::vector<double>& intervals, double interval) {
  std::vector<double> errors;
  for (const double step : intervals) {
    if (step < kMissed * interval) errors.push_back(std::abs(step - interval));
  }
  constexpr double kSigmaOfMedian = 1.4826;  // of a normal distribution
  return errors.size() < kFew ? 0.0 : kSigmaOfMedian * quantile(errors, 0.5) / interval;
}

}  // namespace

std::vector<Finding> judgeStamps(const std::vector<ImageFacts>& images) {
  std::vector<Finding> findings;
  const auto say = [&](Check check, const std::string& what) { findings.push_back({check, what}); };
  const std::size_t n = images.size();
  const double interval = usualInterval(images);
  const Counts counts = countStamps(images, interval);
  if (n > 0 && n < kFew) say(Check::kFewImages, "there are " + std::to_string(n) + " images");
  if (counts.zero > 0) say(Check::kStampsZero, countOf(counts.zero, n) + " have the stamp 0");
  if (counts.repeated > 0)
    say(Check::kStampsRepeated, countOf(counts.repeated, n) + " have the stamp of the one before");
  if (counts.backwards > 0) {
    say(Check::kStampsBackwards, countOf(counts.backwards, n) +
                                     " have stamps before that of an earlier one, by up to " +
                                     duration(counts.furthest_back));
  }
  if (counts.restarts > 0) {
    say(Check::kClockRestarts, "stamps go back by more than " + duration(kRestart) + " " +
                                   std::to_string(counts.restarts) + " times: a clock was set, or bags were joined");
  }
  if (counts.gaps > 0) {
    say(Check::kGaps, std::to_string(counts.gaps) + " gaps, the longest of " + duration(counts.longest) + " at " +
                          number(counts.longest_after, 4) + " s; " + std::to_string(counts.missing) +
                          " images are missing in all");
  }
  const double jitter = jitterOf(counts.intervals, interval);
  if (jitter > kJitter) {
    say(Check::kStampsJitter,
        "intervals of " + duration(interval) + " scatter by " + number(1e2 * jitter) + " %: stamps of arrival?");
  }
  if (interval > 1.0 / kLowRate) say(Check::kLowRate, number(1.0 / interval) + " images a second");
  return findings;
}

}  // namespace mba_vo
