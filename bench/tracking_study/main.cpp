// Measures Tracker::track() on simulated sequences against the exact truth, by class of blur.
//   tracking_study [SEQUENCES=4] [SHARE=1] [LIST] [FIRST=1]
// SEQUENCES: seeds FIRST.. of room and motion; SHARE: part of the frames to be measured; LIST: a file for one line per
// frame, "" for none. Each frame is tracked on its own, relative to a sharp image with true depths, from the guess that
// the motion between the two frames before repeats itself, and from the guess that is left when the frame before is
// lost.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numeric>
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

std::ostream& operator<<(std::ostream& out, const Errors& e) {
  return out << e.mid_px << ' ' << e.motion_px << ' ' << e.converged << ' ' << e.sign_right << ' ' << e.tracking << ' '
             << e.points_within_2px << ' ' << e.pose_nees << ' ' << e.xi_nees;
}

std::ostream& operator<<(std::ostream& out, const Measurement& m) {
  return out << m.blur_px << ' ' << m.prior_error_deg << ' ' << m.reversal << "  " << m.errors << "  " << m.skipping;
}

using Measurements = std::vector<Measurement>;
using Value = double (*)(const Measurement&);
using Chosen = bool (*)(const Measurement&);

bool any(const Measurement&) { return true; }

std::vector<double> collect(const Measurements& measurements, Value value, Chosen chosen) {
  std::vector<double> values;
  for (const Measurement& m : measurements) {
    if (chosen(m)) values.push_back(value(m));
  }
  return values;
}

std::string format(const char* text, double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof(buffer), text, value);
  return buffer;
}

double quantile(std::vector<double> values, double part) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

/// Median and 90 %.
std::string spread(const Measurements& all, Value value, const char* text) {
  const std::vector<double> values = collect(all, value, any);
  if (values.empty()) return "";
  return format(text, quantile(values, 0.5)) + " " + format(text, quantile(values, 0.9));
}

/// Mean over the chosen ones; empty where there are none.
std::string mean(const Measurements& all, Value value, Chosen chosen, double unit, const char* text) {
  const std::vector<double> values = collect(all, value, chosen);
  if (values.empty()) return "";
  return format(text, unit * std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size()));
}

std::string percent(const Measurements& all, Value value, Chosen chosen = any) {
  return mean(all, value, chosen, 100.0, "%.2f %%");
}

struct Seeds {
  int first, count;
};

Measurements measure(const BlurClass& blur, const Seeds& seeds, double share, std::ofstream& list) {
  const Tracker tracker{TrackerConfig()};
  Measurements measurements;
  for (int seed = seeds.first; seed < seeds.first + seeds.count; ++seed) {
    const auto frames = static_cast<int>(std::lround(share * blur.frames_per_sequence));
    Sequence(seed, blur).forEach(frames, [&](const Case& c) {
      const TrackedFrame tracked = tracker.track(*c.reference, c.frame, {c.prior, blur.exposure});
      const TrackedFrame skipping = tracker.track(*c.reference, c.frame, {c.skipping, blur.exposure});
      const Measurement m{compare(c, tracked), compare(c, skipping), c.blur_px,
                          c.prior_error_deg,   tracked.tracking_ms,  c.reversal};
      measurements.push_back(m);
      list << blur.name << ' ' << seed << ' ' << c.frame->sequence << ' ' << m << '\n';
    });
  }
  return measurements;
}

std::vector<std::string> row(const BlurClass& blur, const Measurements& all) {
  using M = const Measurement&;
  const Chosen converged = [](M m) { return m.errors.converged; };
  const Chosen with_covariance = [](M m) { return m.errors.converged && m.blur_px > kBlurWithCovariance; };
  const Chosen with_sign = [](M m) { return m.blur_px >= kBlurWithSign; };
  // The honesty of both attempts counts: the one that is more likely to fail above all.
  const Value honest = [](M m) {
    const int claims = (m.errors.tracking ? 1 : 0) + (m.skipping.tracking ? 1 : 0);
    const int right = (m.errors.tracking && m.errors.points_within_2px ? 1 : 0) +
                      (m.skipping.tracking && m.skipping.points_within_2px ? 1 : 0);
    return static_cast<double>(right) / claims;
  };
  const Chosen claims = [](M m) { return m.errors.tracking || m.skipping.tracking; };
  return {blur.name,
          std::to_string(all.size()),
          spread(
              all, [](M m) { return m.errors.mid_px; }, "%.3f"),
          spread(
              all, [](M m) { return m.errors.motion_px; }, "%.2f"),
          percent(all, [](M m) { return m.errors.converged ? 1.0 : 0.0; }),
          percent(all, [](M m) { return m.skipping.converged ? 1.0 : 0.0; }),
          percent(
              all, [](M m) { return m.errors.sign_right ? 1.0 : 0.0; }, with_sign),
          percent(all, honest, claims),
          mean(
              all, [](M m) { return m.errors.pose_nees; }, converged, 1.0, "%.2f"),
          mean(
              all, [](M m) { return m.errors.xi_nees; }, with_covariance, 1.0, "%.2f"),
          spread(
              all, [](M m) { return m.prior_error_deg; }, "%.2f"),
          percent(all, [](M m) { return m.reversal ? 1.0 : 0.0; }),
          format("%.1f", quantile(collect(
                                      all, [](M m) { return m.ms; }, any),
                                  0.5))};
}

void printRow(const std::vector<std::string>& cells) {
  for (const std::string& cell : cells) std::printf("| %s ", cell.c_str());
  std::printf("|\n");
  std::fflush(stdout);
}

void run(const Seeds& seeds, double share, const std::string& list_file) {
  std::ofstream list(list_file);
  std::printf("Errors: median and 90 %% of the frames. NEES: mean over the converged frames, 1 is right.\n\n");
  const std::vector<std::string> header = {"blur at 2 m [px]",
                                           "frames",
                                           "mid pose, mean over the image [px]",
                                           "motion within the exposure, at the border [px]",
                                           "converged",
                                           "converged, a frame skipped",
                                           "direction right",
                                           "TRACKING is within 2 px",
                                           "NEES of T_mid",
                                           "NEES of xi",
                                           "error of the guess [deg]",
                                           "reversals",
                                           "track() [ms]"};
  printRow(header);
  printRow(std::vector<std::string>(header.size(), "---"));
  for (const BlurClass& blur : kClasses) printRow(row(blur, measure(blur, seeds, share, list)));
}

}  // namespace
}  // namespace mba_vo::study

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  const int sequences = argc > 1 ? std::stoi(argv[1]) : 4;
  const double share = argc > 2 ? std::stod(argv[2]) : 1.0;
  const int first = argc > 4 ? std::stoi(argv[4]) : 1;
  mba_vo::study::run({first, sequences}, share, argc > 3 ? argv[3] : "");
  return 0;
}
