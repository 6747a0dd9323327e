#include "mba_vo/evaluation/clock_offset.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mba_vo/geometry/median.h"

namespace mba_vo {
namespace {

constexpr double kWindow = 0.1;            // over which a speed is measured: less would be noise of the truth [s]
constexpr double kStepsPerWindow = 4.0;    // between speeds, so that the parabola through three finds the top
constexpr double kReach = 10.0;            // [s]
constexpr double kShortest = 2.0;          // of what is compared [s]
constexpr double kLeastCorrelation = 0.7;  // of speeds that are the same but for errors
constexpr double kLeastSpread = 0.03;      // of speeds that tell anything: a hand's is ten times as much [rad/s]
constexpr double kLeastOffset = 0.005;     // [s] less is not told apart from the errors of the method
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Orientation at `time`, between poses that are at most `longest_gap` [s] apart.
std::optional<Eigen::Quaterniond> orientationAt(const std::vector<PoseRecord>& poses, double time, double longest_gap) {
  const auto after = std::lower_bound(poses.begin(), poses.end(), time,
                                      [](const PoseRecord& pose, double t) { return pose.time < t; });
  if (after == poses.begin() || after == poses.end()) return std::nullopt;
  const auto before = std::prev(after);
  const double gap = after->time - before->time;
  if (gap > longest_gap) return std::nullopt;
  return before->T_world_camera.rotation().slerp((time - before->time) / gap, after->T_world_camera.rotation());
}

/// Angular speeds [rad/s] at `begin` + i `step` [s], over `window` [s] each; NaN where they are not known.
std::vector<double> angularSpeeds(const std::vector<PoseRecord>& poses, double begin, double step, std::size_t count,
                                  double window) {
  std::vector<double> speeds(count, kUnknown);
  for (std::size_t i = 0; i < count; ++i) {
    const double time = begin + step * static_cast<double>(i);
    const auto first = orientationAt(poses, time - 0.5 * window, window);
    const auto last = orientationAt(poses, time + 0.5 * window, window);
    if (first && last) speeds[i] = first->angularDistance(*last) / window;
  }
  return speeds;
}

double medianInterval(const std::vector<PoseRecord>& poses) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < poses.size(); ++i) intervals.push_back(poses[i].time - poses[i - 1].time);
  return median(std::move(intervals));
}

/// Pearson's coefficient of a[i] and b[i + shift], where both are known; NaN for fewer than `least` pairs, or speeds
/// that hardly change.
double correlation(const std::vector<double>& a, const std::vector<double>& b, std::size_t shift, std::size_t least) {
  std::size_t n = 0;
  double sum_a = 0.0, sum_b = 0.0, sum_aa = 0.0, sum_bb = 0.0, sum_ab = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double x = a[i], y = b[i + shift];
    if (std::isnan(x) || std::isnan(y)) continue;
    ++n;
    sum_a += x;
    sum_b += y;
    sum_aa += x * x;
    sum_bb += y * y;
    sum_ab += x * y;
  }
  if (n < least) return kUnknown;
  const double count = static_cast<double>(n);
  const double spread_a = std::sqrt(std::max(0.0, sum_aa / count - std::pow(sum_a / count, 2)));
  const double spread_b = std::sqrt(std::max(0.0, sum_bb / count - std::pow(sum_b / count, 2)));
  if (std::min(spread_a, spread_b) < kLeastSpread) return kUnknown;
  return (sum_ab / count - sum_a / count * sum_b / count) / (spread_a * spread_b);
}

/// Whether a peak stands alone: what is further from it than where it has fallen half way to the mean is clearly lower.
bool standsAlone(const std::vector<double>& correlations, std::size_t peak, double mean) {
  constexpr double kClearly = 1.5;  // times as far from 1
  const double half = 0.5 * (correlations[peak] + mean);
  std::size_t first = peak, last = peak;
  while (first > 0 && correlations[first - 1] > half) --first;
  while (last + 1 < correlations.size() && correlations[last + 1] > half) ++last;
  for (std::size_t i = 0; i < correlations.size(); ++i) {
    if (i >= first && i <= last) continue;
    if (1.0 - correlations[i] < kClearly * (1.0 - correlations[peak])) return false;
  }
  return true;
}

/// Where the parabola through three points, one step apart, has its top, from the middle one [steps].
double topOfParabola(double before, double middle, double after) {
  const double curvature = before - 2.0 * middle + after;
  return curvature < 0.0 ? 0.5 * (before - after) / curvature : 0.0;
}

/// Position of the peak, if it is beyond doubt.
std::optional<double> peakOf(const std::vector<double>& correlations) {
  double sum = 0.0, known = 0.0;
  std::size_t peak = 0;
  for (std::size_t i = 0; i < correlations.size(); ++i) {
    if (std::isnan(correlations[i])) continue;
    sum += correlations[i];
    known += 1.0;
    if (!(correlations[peak] >= correlations[i])) peak = i;
  }
  if (peak == 0 || peak + 1 == correlations.size() || !(correlations[peak] >= kLeastCorrelation)) return std::nullopt;
  if (!standsAlone(correlations, peak, sum / known)) return std::nullopt;
  const double top = topOfParabola(correlations[peak - 1], correlations[peak], correlations[peak + 1]);
  return static_cast<double>(peak) + (std::isnan(top) ? 0.0 : top);
}

}  // namespace

std::optional<double> findClockOffset(const std::vector<PoseRecord>& groundtruth,
                                      const std::vector<PoseRecord>& estimate, double guess) {
  if (groundtruth.size() < 3 || estimate.size() < 3) return std::nullopt;
  const double window = std::max({kWindow, 2.0 * medianInterval(estimate), 2.0 * medianInterval(groundtruth)});
  const double step = window / kStepsPerWindow;
  const double begin = estimate.front().time;
  const auto count = static_cast<std::size_t>((estimate.back().time - begin) / step) + 1;
  const auto reach = static_cast<std::size_t>(kReach / step);
  const std::vector<double> estimated = angularSpeeds(estimate, begin, step, count, window);
  const std::vector<double> truth =
      angularSpeeds(groundtruth, begin + guess - step * static_cast<double>(reach), step, count + 2 * reach, window);
  const auto valid = static_cast<double>(
      std::count_if(estimated.begin(), estimated.end(), [](double speed) { return !std::isnan(speed); }));
  const auto least = static_cast<std::size_t>(std::max(0.5 * valid, kShortest / step));

  std::vector<double> correlations;
  for (std::size_t shift = 0; shift <= 2 * reach; ++shift) {
    correlations.push_back(correlation(estimated, truth, shift, least));
  }
  const std::optional<double> peak = peakOf(correlations);
  if (!peak) return std::nullopt;
  const double offset = guess + step * (*peak - static_cast<double>(reach));
  constexpr double kBetter = 2.0;  // times as far from 1
  const double best = correlations[static_cast<std::size_t>(std::lround(*peak))];
  const bool now_as_good = guess == 0.0 && 1.0 - correlations[reach] < kBetter * (1.0 - best);
  return now_as_good || std::abs(offset) < kLeastOffset ? std::nullopt : std::optional<double>(offset);
}

}  // namespace mba_vo
