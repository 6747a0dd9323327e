#include "mba_vo/io/progress_bar.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace mba_vo {
namespace {

/// 65 s: "1:05"; 7210 s: "2:00:10".
std::string durationText(double seconds) {
  constexpr long kSeconds = 60;  // of a minute, minutes of an hour
  const long rounded = std::lround(seconds);
  const long hours = rounded / kSeconds / kSeconds;
  const long minutes = rounded / kSeconds % kSeconds;
  std::ostringstream text;
  text << std::setfill('0');
  if (hours > 0) text << hours << ":" << std::setw(2);
  text << minutes << ":" << std::setw(2) << rounded % kSeconds;
  return text.str();
}

}  // namespace

ProgressBar::ProgressBar(std::ostream& out, std::size_t total, bool enabled, std::size_t left_out)
    : out_(out),
      left_out_(left_out),
      total_(total > left_out ? total - left_out : 1),
      enabled_(enabled),
      begin_(std::chrono::steady_clock::now()) {}

ProgressBar::~ProgressBar() {
  if (drawn_) {
    out_ << "\n";
  }
}

void ProgressBar::update(std::size_t done_in_all) {
  using std::chrono::steady_clock;
  constexpr std::chrono::milliseconds kInterval(100);
  const steady_clock::time_point now = steady_clock::now();
  if (done_in_all <= left_out_) {
    begin_ = now;
    return;
  }
  const std::size_t done = done_in_all - left_out_;
  if (!enabled_ || (drawn_ && done < total_ && now - last_drawn_ < kInterval)) {
    return;
  }
  constexpr std::size_t kWidth = 40;
  const std::size_t filled = std::min(kWidth, kWidth * done / total_);
  const double seconds = std::chrono::duration<double>(now - begin_).count();
  const double rate = seconds > 0.0 ? static_cast<double>(done) / seconds : 0.0;
  out_ << "\r[" << std::string(filled, '=') << std::string(kWidth - filled, ' ') << "] " << done << "/" << total_
       << ", " << std::fixed << std::setprecision(1) << rate << " images/s, " << timeLeft(done, total_, seconds)
       << "   " << std::flush;
  drawn_ = true;
  last_drawn_ = now;
}

std::string timeLeft(std::size_t done, std::size_t total, double seconds) {
  if (done >= total) return "in " + durationText(seconds);
  if (done == 0) return "? left";
  return durationText(seconds * static_cast<double>(total - done) / static_cast<double>(done)) + " left";
}

}  // namespace mba_vo
