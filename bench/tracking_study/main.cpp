// Measures Tracker::track() on simulated sequences against the exact truth, by class of blur.
//   tracking_study [SEQUENCES=4] [SHARE=1] [LIST]
// SEQUENCES: seeds 1.. of room and motion; SHARE: part of the frames to be measured; LIST: a file for one line per
// frame. Each frame is tracked on its own, relative to a sharp image with true depths, from the guess that the motion
// between the two frames before repeats itself, and from the guess that is left when the frame before is lost.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include <opencv2/core/utility.hpp>

#include "errors.h"
#include "mba_vo/tracking/tracker.h"
#include "sequence.h"

namespace mba_vo::study {
namespace {

constexpr double kBlurWithSign = 2.0;        // [px] from here on the sign of the motion must be right
constexpr double kBlurWithCovariance = 3.0;  // [px] from here on the covariance of xi must be right

const BlurClass kClasses[] = {{"0-2", 0.0015, 0.0, 2.0, 250},
                              {"2-7", 0.008, 2.0, 7.0, 120},
                              {"10", 0.015, 7.0, 14.0, 120},
                              {"40", 0.03, 28.0, 56.0, 75}};

struct Measurement {
  Errors errors, skipping;
  double blur_px = 0.0, prior_error_deg = 0.0, ms = 0.0;
  bool reversal = false;
};

double quantile(std::vector<double> values, double part) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// Values of the measurements that `chosen` is true for.
template <typename Value, typename Chosen>
std::vector<double> collect(const std::vector<Measurement>& measurements, const Value& value, const Chosen& chosen) {
  std::vector<double> values;
  for (const Measurement& m : measurements) {
    if (chosen(m)) values.push_back(static_cast<double>(value(m)));
  }
  return values;
}

std::vector<Measurement> measure(const BlurClass& blur, int sequences, double share, std::ofstream& list) {
  const Tracker tracker{TrackerConfig()};
  std::vector<Measurement> measurements;
  for (int seed = 1; seed <= sequences; ++seed) {
    const auto frames = static_cast<int>(std::lround(share * blur.frames_per_sequence));
    Sequence(seed, blur).forEach(frames, [&](const Case& c) {
      const TrackedFrame tracked = tracker.track(*c.reference, c.frame, {c.prior, blur.exposure});
      const TrackedFrame skipping = tracker.track(*c.reference, c.frame, {c.skipping, blur.exposure});
      const Measurement m{compare(c, tracked), compare(c, skipping), c.blur_px,
                          c.prior_error_deg,   tracked.tracking_ms,  c.reversal};
      measurements.push_back(m);
      list << blur.name << ' ' << seed << ' ' << c.frame->sequence << ' ' << m.blur_px << ' ' << m.prior_error_deg
           << ' ' << m.reversal << "  " << m.errors.mid_px << ' ' << m.errors.motion_px << ' ' << m.errors.converged
           << ' ' << m.errors.sign_right << ' ' << m.errors.pose_nees << ' ' << m.errors.xi_nees << ' '
           << toString(tracked.status) << "  " << m.skipping.mid_px << ' ' << m.skipping.motion_px << ' '
           << m.skipping.converged << ' ' << toString(skipping.status) << '\n';
    });
  }
  return measurements;
}

void print(const BlurClass& blur, const std::vector<Measurement>& all) {
  const auto any = [](const Measurement&) { return true; };
  const auto converged = [](const Measurement& m) { return m.errors.converged; };
  const auto with_covariance = [](const Measurement& m) {
    return m.errors.converged && m.blur_px > kBlurWithCovariance;
  };
  const auto with_sign = [](const Measurement& m) { return m.blur_px >= kBlurWithSign; };
  const auto tracking = [](const Measurement& m) { return m.errors.tracking; };
  const auto tracking_skipping = [](const Measurement& m) { return m.skipping.tracking; };
  const auto mid = collect(
      all, [](const Measurement& m) { return m.errors.mid_px; }, any);
  const auto motion = collect(
      all, [](const Measurement& m) { return m.errors.motion_px; }, any);
  const auto prior = collect(
      all, [](const Measurement& m) { return m.prior_error_deg; }, any);
  auto honest = collect(
      all, [](const Measurement& m) { return m.errors.points_within_2px; }, tracking);
  const auto honest_skipping = collect(
      all, [](const Measurement& m) { return m.skipping.points_within_2px; }, tracking_skipping);
  honest.insert(honest.end(), honest_skipping.begin(), honest_skipping.end());
  std::printf(
      "| %-5s | %5zu | %5.3f %5.3f | %5.2f %5.2f | %6.2f %% | %6.2f %% | %4.2f | %4.2f | %6.2f %% | %6.2f %% | "
      "%4.2f %4.2f %2.0f %% | %4.1f |\n",
      blur.name, all.size(), quantile(mid, 0.5), quantile(mid, 0.9), quantile(motion, 0.5), quantile(motion, 0.9),
      100.0 * mean(collect(
                  all, [](const Measurement& m) { return m.errors.converged; }, any)),
      100.0 * mean(collect(
                  all, [](const Measurement& m) { return m.skipping.converged; }, any)),
      mean(collect(
          all, [](const Measurement& m) { return m.errors.pose_nees; }, converged)),
      mean(collect(
          all, [](const Measurement& m) { return m.errors.xi_nees; }, with_covariance)),
      100.0 * mean(collect(
                  all, [](const Measurement& m) { return m.errors.sign_right; }, with_sign)),
      100.0 * mean(honest), quantile(prior, 0.5), quantile(prior, 0.9),
      100.0 * mean(collect(
                  all, [](const Measurement& m) { return m.reversal; }, any)),
      quantile(collect(
                   all, [](const Measurement& m) { return m.ms; }, any),
               0.5));
  std::fflush(stdout);
}

void run(int sequences, double share, const std::string& list_file) {
  std::ofstream list(list_file);
  std::printf(
      "Errors: median and 90 %% of the frames. NEES: mean over the converged frames, 1 is right. Guess: rotation "
      "error\n"
      "median and 90 %% [deg], and the share of frames where the camera begins to turn the other way.\n\n"
      "| blur at 2 m [px] | frames | mid pose [px] | motion at the border [px] | converged | converged, a frame "
      "skipped | "
      "NEES of T_mid | NEES of xi | sign right | TRACKING is within 2 px | guess | track() [ms] |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const BlurClass& blur : kClasses) print(blur, measure(blur, sequences, share, list));
}

}  // namespace
}  // namespace mba_vo::study

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  const int sequences = argc > 1 ? std::stoi(argv[1]) : 4;
  const double share = argc > 2 ? std::stod(argv[2]) : 1.0;
  mba_vo::study::run(sequences, share, argc > 3 ? argv[3] : "");
  return 0;
}
